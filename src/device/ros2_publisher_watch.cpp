#include "device/internal/ros2_publisher_watch.hpp"

#include <algorithm>
#include <utility>

namespace pingvox {

void Ros2PublisherWatch::note(std::uint64_t publisher, double now_s) {
  constexpr double kPeriod_s = 30.0;
  constexpr std::size_t kSurely = 2;  // one may be a message that was on its way
  if (std::exchange(last_, publisher) == publisher) return;
  std::erase_if(known_, [&](const auto& one) { return now_s - one.second.since_s > kPeriod_s; });
  const auto [known, is_new] = known_.try_emplace(publisher, Known{now_s, 0});
  if (is_new) return;
  ++known->second.returns;
  const auto surely = std::ranges::count_if(known_, [](const auto& one) { return one.second.returns >= kSurely; });
  if (surely > 1) together_ = std::max(together_, static_cast<std::size_t>(surely));
}

}  // namespace pingvox
