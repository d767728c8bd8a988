#include "sonar/internal/beams_ahead.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

namespace pingvox::test {
namespace {

/// Beams of 1, 2, 3 ... bins of 1 m, and then an error or the end.
class CountedBeams final : public BeamSource {
 public:
  CountedBeams(std::size_t count, bool fails) : count_(count), fails_(fails) {}

  Result<std::optional<Beam>> next() override {
    if (given_ < count_) {
      Beam beam;
      beam.bin_length_m = 1.0;
      beam.intensities.assign(++given_, 7);
      return beam;
    }
    if (fails_) return fail(Error::Code::kCorrupt, "broken");
    return std::nullopt;
  }

 private:
  std::size_t count_, given_ = 0;
  bool fails_;
};

TEST(BeamsAhead, GiveAllBeamsAndThenTheEndOrTheError) {
  std::size_t cases = 0;
  for (const std::size_t count : {0U, 1U, 4U, 5U, 6U, 20U}) {
    for (const bool fails : {false, true}) {
      BeamsAhead beams(std::make_unique<CountedBeams>(count, fails), 5);
      EXPECT_EQ(beams.count(), std::min<std::size_t>(count, 5));
      EXPECT_EQ(beams.has_ended(), count < 5);
      for (std::size_t n = 1; n <= count; ++n) {
        const auto beam = beams.next();
        ASSERT_TRUE(beam && *beam);
        EXPECT_EQ((*beam)->intensities.size(), n);
      }
      const auto last = beams.next();
      EXPECT_EQ(last.has_value(), !fails);
      if (last) {
        EXPECT_FALSE(last->has_value());
      }
      ++cases;
    }
  }
  EXPECT_EQ(cases, 12U);
}

TEST(BeamsAhead, TellTheUsualRange) {
  EXPECT_EQ(BeamsAhead(std::make_unique<CountedBeams>(0, false), 5).usual_range_m(), std::nullopt);
  EXPECT_EQ(BeamsAhead(std::make_unique<CountedBeams>(5, false), 9).usual_range_m(), 3.0);
  EXPECT_EQ(BeamsAhead(std::make_unique<CountedBeams>(50, false), 9).usual_range_m(), 5.0) << "of the first";
}

}  // namespace
}  // namespace pingvox::test
