#include "live/obstacle_sender.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "io/internal/mavlink.hpp"
#include "io/internal/mavlink_obstacles.hpp"

namespace pingvox {
namespace {

ObstacleDistance message_of(const ObstacleSectors& obstacles, const ObstacleOptions& options) {
  const auto cm_of = [](double metres) { return static_cast<std::uint16_t>(std::lround(metres * 100.0)); };
  ObstacleDistance message;
  message.time_us = static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
          .count());
  message.min_cm = cm_of(options.min_range_m);
  message.max_cm = cm_of(options.max_range_m);
  std::ranges::transform(obstacles.sectors, message.cm.begin(), [&](const ObstacleSectors::Sector& sector) {
    using What = ObstacleSectors::What;
    if (sector.what == What::kObstacle) return cm_of(sector.range_m);
    return sector.what == What::kClear ? static_cast<std::uint16_t>(message.max_cm + 1) : ObstacleDistance::kUnknown;
  });
  return message;
}

}  // namespace

ObstacleSender::ObstacleSender(const std::string& address, const ObstacleOptions& options)
    : address_(address), opening_(address), options_(options) {}

void ObstacleSender::open(double now_s) {
  constexpr double kDelay_s = 5.0;
  if (!opening_ && now_s < open_at_s_) return;
  if (!opening_) opening_.emplace(address_);
  std::optional<Result<Link>> link = opening_->take();
  if (!link) return;
  opening_.reset();
  if (*link) {
    link_ = *std::move(*link);
    problem_.clear();
  } else {
    problem_ = link->error().message;
    open_at_s_ = now_s + kDelay_s;
  }
}

void ObstacleSender::send(const OccupancyMap& map, const std::optional<Pose>& map_from_body, double now_s) {
  constexpr double kEvery_s = 0.2;
  constexpr std::uint8_t kObstacleAvoidance = 196;  // a component
  due_s_ = now_s + kEvery_s;
  if (!link_) open(now_s);
  if (!link_ || !map_from_body) return;
  const ObstacleDistance message = message_of(nearest_obstacles(map, *map_from_body, options_), options_);
  const MavlinkSender sender = {.sequence = sequence_++, .component = kObstacleAvoidance};
  // A lost message is replaced by the next one.
  static_cast<void>(link_->write(make_mavlink_frame(kObstacleDistance, payload_of(message), sender)));
}

}  // namespace pingvox
