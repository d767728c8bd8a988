#include "day.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include "bench/paired_timing.hpp"
#include "bench/vehicle/tank_head.hpp"
#include "device/internal/link.hpp"
#include "device/internal/live_source.hpp"
#include "pingvox/mapping/beam_mapper.hpp"

namespace pingvox::bench {
namespace {

constexpr double kHour_s = 3600.0, kDay_s = 24.0 * kHour_s;
constexpr double kPings_per_s = 10.0;
/// What may be added to the process after its first hour.
constexpr double kMaxGrowth_mb = 2.0;

double resident_mb() {
  return static_cast<double>(resident_bytes()) / 1e6;
}

/// A head and its host at two ends of a socket, and a clock that they share.
class Day {
 public:
  Day(Link end, std::unique_ptr<LiveSource> source, BeamMapper& mapper)
      : end_(std::move(end)),
        head_({.pings_per_s = kPings_per_s}, hear_in_tank()),
        source_(std::move(source)),
        mapper_(&mapper) {}

  /// Lets the time pass to the next event of either.
  Result<void> step() {
    std::vector<Beam> beams;
    const Result<bool> goes_on = source_->step(now_s_, beams);
    if (!goes_on) return tl::unexpected(goes_on.error());
    for (Beam& beam : beams) {
      ++beams_;
      if (const auto added = mapper_->add(std::move(beam), Pose::Identity()); !added) return added;
    }
    for (;;) {
      const Result<std::size_t> got = end_.read(bytes_);
      if (!got) return tl::unexpected(got.error());
      if (*got == 0) break;
      head_.take(std::span(bytes_).first(*got), now_s_);
    }
    now_s_ = std::max(now_s_, std::min(head_.due_s(), source_->due_s()));
    if (head_.due_s() > now_s_) return {};
    return end_.write(head_.send(now_s_));
  }

  double now_s() const { return now_s_; }
  std::size_t beams() const { return beams_; }
  std::size_t pings() const { return head_.pings(); }
  HeadStatus status() const { return source_->status(); }

 private:
  Link end_;
  Ping360Emulator head_;
  std::unique_ptr<LiveSource> source_;
  BeamMapper* mapper_;
  std::array<std::uint8_t, 65536> bytes_{};
  double now_s_ = 0.0;
  std::size_t beams_ = 0;
};

}  // namespace

Result<std::vector<Row>> day(const BenchOptions&) {
  Result<Link> end = Link::listen("udp://127.0.0.1:0");
  if (!end) return tl::unexpected(end.error());
  std::unique_ptr<LiveSource> source = ping360_source(end->address(), {.range_m = 10.0}, std::nullopt, 0.0);
  OccupancyMap map({.resolution_m = 0.05});
  Result<BeamMapper> mapper = BeamMapper::make({}, map);
  if (!mapper) return tl::unexpected(mapper.error());
  const auto start = std::chrono::steady_clock::now();
  const auto day = std::make_unique<Day>(*std::move(end), std::move(source), *mapper);
  double first_hour_mb = 0.0;
  while (day->now_s() < kDay_s) {
    if (const auto stepped = day->step(); !stepped) return tl::unexpected(stepped.error());
    if (first_hour_mb == 0.0 && day->now_s() >= kHour_s) first_hour_mb = resident_mb();
  }
  const double end_mb = resident_mb();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (const auto finished = mapper->finish(); !finished) return tl::unexpected(finished.error());

  const HeadStatus status = day->status();
  // The last ping may be on its way.
  const bool has_all = day->beams() + 1 >= day->pings() && mapper->report().beams == day->beams();
  if (!has_all || status.unanswered + status.damaged > 0 || status.connections != 1) {
    return fail(
        Error::Code::kCorrupt,
        fmt::format("of {} pings {} were received and {} mapped; {} requests without an answer, {} damaged frames, "
                    "{} connections",
                    day->pings(), day->beams(), mapper->report().beams, status.unanswered, status.damaged,
                    status.connections));
  }
  if (end_mb > first_hour_mb + kMaxGrowth_mb) {
    return fail(Error::Code::kCorrupt,
                fmt::format("the process grew from {:.1f} MB after an hour to {:.1f} MB", first_hour_mb, end_mb));
  }
  Row row;
  row.add("name", "day")
      .add_truth("checked", true)
      .add("beams", std::uint64_t{day->beams()})
      .add("seconds", seconds)
      .add("times_real_time", kDay_s / seconds)
      .add("hour_mb", first_hour_mb)
      .add("day_mb", end_mb);
  return std::vector{row};
}

}  // namespace pingvox::bench
