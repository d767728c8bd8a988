#include "pingvox/io/points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "pingvox/io/beams.hpp"
#include "pingvox/io/file.hpp"

namespace pingvox {
namespace {

class Scans final : public ScanSource {
 public:
  explicit Scans(std::vector<PointScan> scans) : scans_(std::move(scans)) {}
  Result<std::optional<PointScan>> next() override {
    if (at_ == scans_.size()) return std::nullopt;
    return scans_[at_++];
  }

 private:
  std::vector<PointScan> scans_;
  std::size_t at_ = 0;
};

// Kills a writer that takes the first scan alone, or moves points by the origin of their scan.
TEST(WritePoints, ReadersFindThePointsOfAllScans) {
  const std::vector<PointScan> two = {
      {.origin_m = {1.0, 2.0, 3.0}, .points_m = {{0.1, -2.5, 1e-3}, {40.0, 0.0, -7.25}}},
      {.origin_m = {5.0, 0.0, 0.0}, .points_m = {{-3.0, 1.0, 2.0}}}};
  std::vector<Eigen::Vector3d> expected;
  for (const PointScan& scan : two) expected.insert(expected.end(), scan.points_m.begin(), scan.points_m.end());
  for (const Format format : {Format::kPly, Format::kPcd, Format::kXyz}) {
    SCOPED_TRACE(name_of(format));
    Scans scans(two);
    std::ostringstream out;
    const Result<std::size_t> written = write_points(scans, format, out);
    ASSERT_TRUE(written) << written.error().message;
    EXPECT_EQ(*written, 3U);
    const std::string bytes = std::move(out).str();
    const auto cloud = open_scans({"cloud", {bytes.begin(), bytes.end()}});
    ASSERT_TRUE(cloud) << cloud.error().message;
    const Result<std::optional<PointScan>> read = (*cloud)->next();
    ASSERT_TRUE(read);
    ASSERT_TRUE(*read);
    ASSERT_EQ((*read)->points_m.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_LT(((*read)->points_m[i] - expected[i]).norm(), 1e-5);
    }
  }
}

TEST(WritePoints, RefusesOtherFormats) {
  Scans scans({});
  std::ostringstream out;
  const Result<std::size_t> written = write_points(scans, Format::kBt, out);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, Error::Code::kUnsupported);
  EXPECT_THAT(written.error().message, testing::HasSubstr(".bt"));
}

}  // namespace
}  // namespace pingvox
