#include "io/internal/beams_in_order.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace pingvox {
namespace {

class BeamsAt final : public BeamSource {
 public:
  explicit BeamsAt(std::vector<double> times_s) : times_s_(std::move(times_s)) {}
  Result<std::optional<Beam>> next() override {
    if (next_ == times_s_.size()) return std::nullopt;
    Beam beam;
    beam.time_s = times_s_[next_++];
    return beam;
  }

 private:
  std::vector<double> times_s_;
  std::size_t next_ = 0;
};

/// The times of all beams, and what the end says.
std::pair<std::vector<double>, std::string> read(std::vector<double> times_s) {
  const auto source = in_order(std::make_unique<BeamsAt>(std::move(times_s)), "dive.bag");
  std::vector<double> read_s;
  for (;;) {
    const Result<std::optional<Beam>> beam = source->next();
    if (!beam) return {read_s, beam.error().message};
    if (!*beam) return {read_s, ""};
    read_s.push_back((*beam)->time_s);
  }
}

// Kills a beam that is left out or comes twice, and a log that is refused for swapped messages.
TEST(BeamsInOrder, SwappedOnesGoToTheirPlaces) {
  using Times = std::vector<double>;
  EXPECT_EQ(read({0, 0.5, 1, 3, 1.5, 3.5, 9, 9.5}), std::pair(Times({0, 0.5, 1, 1.5, 3, 3.5, 9, 9.5}), std::string()));
  EXPECT_EQ(read({}), std::pair(Times(), std::string()));
  EXPECT_EQ(read({5}), std::pair(Times({5}), std::string()));
}

// Kills beams of a clock that was set back by two seconds among those that came before.
TEST(BeamsInOrder, AClockThatWasSetBackIsAnError) {
  const auto [read_s, error] = read({0, 0.5, 1, 1.5, 2, 2.5, 0.7, 1.2, 1.7, 2.2, 2.7, 3.2});
  EXPECT_EQ(read_s.size(), 12U);
  EXPECT_THAT(error, testing::HasSubstr("dive.bag: its clock runs back by 1.800 s, from 2.500 to 0.700 s"));
}

}  // namespace
}  // namespace pingvox
