#include "web/live_news.hpp"

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>

#include "web/live_path.hpp"
#include "web/live_status.hpp"

namespace pingvox::web {

void NewsGatherer::note_latency(double latency_s) {
  latency_s_ = std::max(latency_s_, latency_s);
}

void NewsGatherer::tell(std::string message) {
  constexpr std::size_t kMaxMessages = 5;
  messages_.push_back(std::move(message));
  if (messages_.size() > kMaxMessages) messages_.pop_front();
  ++told_;
}

LiveNews NewsGatherer::gather(LiveMapping& live, double now_s, std::atomic<bool>& wants_free) {
  LiveNews news;
  LiveChanges changes = live.take_changes();
  if (std::exchange(is_lost_, false)) changes.map.all = true;
  Result<CellChanges> cells = changed_cells(live.map(), changes.map);
  if (!cells) {
    if (!std::exchange(has_failed_, true)) tell(cells.error().message);
  } else {
    news.cells = *std::move(cells);
  }
  news.beams = std::move(changes.beams);
  const LiveStatus status = live.status();
  if (status.slam && status.slam->corrections != corrections_) {
    corrections_ = status.slam->corrections;
    if (const std::optional<Trajectory> path = live.path()) news.path = LivePath::thinned(path->poses());
  }
  news.pose = live.pose();
  if (status.mapped != mapped_) mapped_s_ = now_s;
  if (!news.beams.empty()) beam_s_ = now_s;
  mapped_ = status.mapped;
  note_rate(live.beams(), now_s);
  // It takes some ms, which beams would have to wait for.
  constexpr double kObstaclesEvery_s = 1.0;
  if (now_s >= obstacles_due_s_) {
    obstacles_ = live_obstacles(live);
    obstacles_due_s_ = now_s + kObstaclesEvery_s;
  }
  // A copy takes some ms, too.
  constexpr double kFreeEvery_s = 1.0;
  if (now_s >= free_due_s_ && wants_free.exchange(false)) {
    news.map = live.map();
    free_due_s_ = now_s + kFreeEvery_s;
  }
  const LiveFigures figures = {.latency_s = std::exchange(latency_s_, 0.0),
                               .beams_per_s = beams_per_s_,
                               .map_age_s = now_s - mapped_s_,
                               .beam_age_s = now_s - beam_s_,
                               .obstacles = obstacles_};
  const std::vector<std::string> messages(messages_.begin(), messages_.end());
  news.status = live_status_json(live, status, figures, axes_)
                    .add("messages", std::span<const std::string>(messages))
                    .add("told", std::uint64_t{told_});
  return news;
}

/// Over a second or more, as beams come unevenly.
void NewsGatherer::note_rate(std::size_t beams, double now_s) {
  constexpr double kMinPeriod_s = 1.0;
  if (now_s - rated_s_ < kMinPeriod_s) return;
  beams_per_s_ = static_cast<double>(beams - rated_beams_) / (now_s - rated_s_);
  rated_s_ = now_s;
  rated_beams_ = beams;
}

}  // namespace pingvox::web
