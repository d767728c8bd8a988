#include "live/beam_queue.hpp"

#include <algorithm>
#include <optional>

#include "pingvox/geometry/pose.hpp"

namespace pingvox {

void BeamQueue::push(std::vector<Beam>& arrived, double now_s) {
  constexpr std::size_t kMaxWaiting = 2000;  // at most 2.4 MB of a Ping360
  beams_ += arrived.size();
  for (Beam& beam : arrived) waiting_.push_back({std::move(beam), now_s});
  arrived.clear();
  for (; waiting_.size() > kMaxWaiting; waiting_.pop_front()) ++dropped_;
}

bool BeamQueue::can_map_one(const LiveNavigation* nav, double now_s) const {
  if (waiting_.empty()) return false;
  if (has_failed_) return true;
  const auto& [beam, arrived_s] = waiting_.front();
  if (slam() != nullptr) return !slam()->may_come(beam.time_s, now_s);
  return nav == nullptr || !nav->may_come(beam.time_s, arrived_s);
}

Result<void> BeamQueue::map_one(const LiveNavigation* nav, const std::function<double()>& clock) {
  auto [beam, arrived_s] = std::move(waiting_.front());
  waiting_.pop_front();
  if (has_failed_) {
    ++dropped_;
    return {};
  }
  Result<void> added = add(std::move(beam), nav, clock());
  if (!added) added = give_up(added.error());
  latency_s_ = std::max(latency_s_, clock() - arrived_s);
  return added;
}

Result<void> BeamQueue::add(Beam beam, const LiveNavigation* nav, double now_s) {
  if (slam() != nullptr) return slam()->add(std::move(beam), now_s);
  const std::optional<Pose> pose = nav != nullptr ? nav->poses().at(beam.time_s) : Pose::Identity();
  ++asked_.beams;
  if (!pose) {
    ++without_pose_;
    ++asked_.without_pose;
  }
  return std::get<BeamMapper>(mapper_).add(std::move(beam), pose);
}

Result<void> BeamQueue::update(double now_s) {
  if (slam() == nullptr || has_failed_) return {};
  const Result<void> updated = slam()->update(now_s);
  return updated ? updated : give_up(updated.error());
}

Result<void> BeamQueue::finish() {
  if (has_failed_) return {};
  is_finished_ = true;
  const Result<void> finished = std::visit([](auto& mapper) { return mapper.finish(); }, mapper_);
  return finished ? finished : give_up(finished.error());
}

std::size_t BeamQueue::restart(Mapper mapper) {
  mapper_ = std::move(mapper);
  const std::size_t before = std::exchange(beams_, waiting_.size()) - waiting_.size();
  without_pose_ = dropped_ = 0;
  has_failed_ = is_finished_ = false;
  return before;
}

std::size_t BeamQueue::not_mapped() const {
  const BuildReport& report = this->report();
  return dropped_ + without_pose() + report.blocked.count + report.too_long.count;
}

/// Beams that the mapper held are lost with an error.
Result<void> BeamQueue::give_up(const Error& error) {
  has_failed_ = true;
  dropped_ += waiting() - waiting_.size();
  return tl::unexpected(error);
}

}  // namespace pingvox
