#include "live.hpp"

#include <fmt/core.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <string_view>
#include <thread>
#include <utility>

#include "bench/paired_timing.hpp"
#include "bench/vehicle/tank_head.hpp"
#include "device/internal/link.hpp"
#include "device/internal/live_source.hpp"
#include "device/internal/ping360_emulator.hpp"
#include "pingvox/analysis/compare.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/mapping/beam_mapper.hpp"
#include "pingvox/mapping/build_map.hpp"

namespace pingvox::bench {
namespace {

constexpr double kCell_m = 0.05, kRange_m = 10.0;
constexpr double kPings_per_s = 200.0;  ///< several times what a Ping360 does
constexpr std::size_t kBeams = 2000;

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Each beam updates the map as it comes.
BuildOptions live_options() {
  BuildOptions options;
  options.model.shape = BeamShape::kCone;
  options.model.width_rad = 2.0 * kDegree_rad;
  options.model.height_rad = 25.0 * kDegree_rad;
  options.vote = Vote::kPerBeam;
  options.timing = Timing::kByBeam;
  return options;
}

/// The head, in a thread of its own.
class Head {
 public:
  explicit Head(Link link) : link_(std::move(link)), thread_([this] { run(); }) {}
  Head(const Head&) = delete;
  Head& operator=(const Head&) = delete;
  ~Head() {
    stops_ = true;
    thread_.join();
  }

  /// When the last byte of a ping was sent.
  double sent_s(std::size_t ping) {
    const std::lock_guard lock(mutex_);
    return sent_s_.at(ping);
  }

 private:
  void run() {
    Ping360Emulator head({.pings_per_s = kPings_per_s}, hear_in_tank());
    std::vector<std::uint8_t> bytes(65536);
    while (!stops_) {
      const double wait_ms = std::ceil(1e3 * std::clamp(head.due_s() - now_s(), 0.0, 0.1));
      std::array<pollfd, 1> files = {pollfd{link_.descriptor(), POLLIN, 0}};
      ::poll(files.data(), files.size(), static_cast<int>(wait_ms));
      const Result<std::size_t> got = link_.read(bytes);
      if (!got) return;
      head.take(std::span(bytes).first(*got), now_s());
      const std::size_t pings = head.pings();
      const std::vector<std::uint8_t> frame = head.send(now_s());
      if (head.pings() > pings) {
        const std::lock_guard lock(mutex_);
        sent_s_.push_back(now_s());
      }
      if (!link_.write(frame)) return;
    }
  }

  Link link_;
  std::mutex mutex_;
  std::vector<double> sent_s_;
  std::atomic<bool> stops_ = false;
  std::thread thread_;  ///< last: it uses the others
};

/// Maps what comes and measures when each beam has had its effect. @return the times [s]
Result<std::vector<double>> map_beams(LiveSource& source, Head& head, BeamMapper& mapper, std::vector<Beam>& beams) {
  constexpr double kPatience_s = 60.0;
  std::vector<double> latencies_s;
  const double end_s = now_s() + kPatience_s;
  while (latencies_s.size() < kBeams && now_s() < end_s) {
    std::array<pollfd, 1> files = {pollfd{source.descriptor(), POLLIN, 0}};
    ::poll(files.data(), files.size(),
           static_cast<int>(std::ceil(1e3 * std::clamp(source.due_s() - now_s(), 0.0, 1.0))));
    std::vector<Beam> arrived;
    const Result<bool> goes_on = source.step(now_s(), arrived);
    if (!goes_on) return tl::unexpected(goes_on.error());
    for (Beam& beam : arrived) {
      beams.push_back(beam);
      if (const auto added = mapper.add(std::move(beam), Pose::Identity()); !added) {
        return tl::unexpected(added.error());
      }
      latencies_s.push_back(now_s() - head.sent_s(latencies_s.size()));
    }
  }
  if (latencies_s.size() < kBeams) {
    return fail(Error::Code::kIo, fmt::format("{} of {} beams in {:.0f} s", latencies_s.size(), kBeams, kPatience_s));
  }
  return latencies_s;
}

/// Checks that the map is the one of the same beams as a log.
Result<void> check_map(const std::vector<Beam>& beams, const BuildOptions& options, const OccupancyMap& live_map) {
  OccupancyMap map({.resolution_m = kCell_m});
  BeamsInMemory log(beams);
  const auto built = build_map(log, Trajectory::still(Pose::Identity()), options, map);
  if (!built) return tl::unexpected(built.error());
  const auto found = compare_maps(live_map, map, Sameness::kLogOdds);
  if (!found) return tl::unexpected(found.error());
  if (found->same > 0 && found->same == found->cells()) return {};
  return fail(Error::Code::kCorrupt,
              fmt::format("{} of {} cells are as in the map of the same beams as a log", found->same, found->cells()));
}

/// Without neighbours that affect its echo, a beam changes its cells before the next one comes.
BuildOptions at_once_options() {
  BuildOptions options = live_options();
  options.filter = {.filter = Filter::kNone};
  options.echo.threshold = 70;
  return options;
}

Result<Row> measure(std::string_view name, const BuildOptions& options) {
  Result<Link> link = Link::listen("udp://127.0.0.1:0");
  if (!link) return tl::unexpected(link.error());
  const std::string address = link->address();
  Head head(*std::move(link));
  const std::unique_ptr<LiveSource> source = ping360_source(address, {.range_m = kRange_m}, std::nullopt, now_s());
  OccupancyMap map({.resolution_m = kCell_m});
  Result<BeamMapper> mapper = BeamMapper::make(options, map);
  if (!mapper) return tl::unexpected(mapper.error());
  std::vector<Beam> beams;
  const Result<std::vector<double>> latencies_s = map_beams(*source, head, *mapper, beams);
  if (!latencies_s) return tl::unexpected(latencies_s.error());
  if (const auto finished = mapper->finish(); !finished) return tl::unexpected(finished.error());
  const HeadStatus status = source->status();
  if (status.unanswered + status.damaged > 0) {
    return fail(Error::Code::kCorrupt,
                fmt::format("{} requests without an answer, {} damaged frames", status.unanswered, status.damaged));
  }
  if (const auto same = check_map(beams, options, map); !same) return tl::unexpected(same.error());
  Row row;
  row.add("name", name)
      .add_truth("checked", true)
      .add("beams", std::uint64_t{beams.size()})
      .add("samples", std::uint64_t{beams.front().intensities.size()})
      .add("beams_per_s", kPings_per_s)
      .add("delay_beams", std::uint64_t{mapper->delay_beams().value_or(0)})
      .add("p50_ms", 1e3 * percentile(*latencies_s, 0.5))
      .add("p99_ms", 1e3 * percentile(*latencies_s, 0.99))
      .add("max_ms", 1e3 * percentile(*latencies_s, 1.0));
  return row;
}

}  // namespace

Result<std::vector<Row>> live(const BenchOptions&) {
  std::vector<Row> rows;
  for (const auto& [name, options] :
       {std::pair("live", live_options()), std::pair("live at once", at_once_options())}) {
    Result<Row> row = measure(name, options);
    if (!row) return tl::unexpected(row.error());
    rows.push_back(*std::move(row));
  }
  return rows;
}

}  // namespace pingvox::bench
