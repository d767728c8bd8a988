#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "console.hpp"
#include "evaluation_text.hpp"
#include "info_summary.hpp"
#include "open_log.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/mapping/beam_model.hpp"
#include "pingvox/nav/time_order.hpp"
#include "pingvox/sonar/beam_pauses.hpp"
#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/sonar/device_profile.hpp"
#include "pingvox/sonar/filters.hpp"
#include "pingvox/sonar/sweep.hpp"
#include "stopwatch.hpp"
#include "threshold_range.hpp"

namespace pingvox::app {
namespace {

/// Angle covered by the head: a full turn, or all but the widest gap between bearings.
double sector_deg(std::vector<double> bearings_rad, bool has_turn) {
  if (has_turn) return 360.0;
  if (bearings_rad.empty()) return 0.0;
  constexpr double kTurn_rad = 2.0 * std::numbers::pi;
  std::sort(bearings_rad.begin(), bearings_rad.end());
  double widest = bearings_rad.front() + kTurn_rad - bearings_rad.back();
  for (std::size_t i = 1; i < bearings_rad.size(); ++i) {
    widest = std::max(widest, bearings_rad[i] - bearings_rad[i - 1]);
  }
  return rounded_degrees(kTurn_rad - widest);
}

std::string_view name_of(BeamClock clock) {
  switch (clock) {
    case BeamClock::kTimeOfDay:
      return "time of day";
    case BeamClock::kNone:
      return "none";
    default:
      return "own";
  }
}

void add_device(Summary& summary, const DeviceProfile& device, Format format) {
  const double width_deg = rounded_degrees(device.beam_width_rad), height_deg = rounded_degrees(device.beam_height_rad);
  JsonObject json;
  json.add("name", device.name)
      .add("beam_width_deg", width_deg)
      .add("beam_height_deg", height_deg)
      .add("blanking_m", device.blanking_m)
      .add("full_scale", device.full_scale);
  summary.json.add("device", json);
  summary.text += report_line(
      "device", fmt::format("{}, beam {:.6g} x {:.6g} degrees (--device); its maker's minimum range is {:.6g} m",
                            device.title, width_deg, height_deg, device.blanking_m));
  // Bins that were hit have none.
  if (format != Format::kBeamHits) summary.text += report_line("intensities", std::string(device.intensity));
}

using BinLengths = std::vector<std::pair<double, std::size_t>>;  ///< [m], with the beams that have it
constexpr std::size_t kMaxListed = 8;

/// As a report shows a length.
std::string length_text(double length_m) {
  return fmt::format("{:.6g}", length_m);
}

/// Lengths that a report shows alike are one: that of most beams. They differ by rounding.
/// @param beams  by length
BinLengths distinct_lengths(const std::map<double, std::size_t>& beams) {
  BinLengths lengths;
  std::size_t most = 0;
  for (const auto& [length_m, count] : beams) {
    if (lengths.empty() || length_text(lengths.back().first) != length_text(length_m)) {
      lengths.emplace_back(length_m, count);
      most = count;
      continue;
    }
    lengths.back().second += count;
    if (count <= most) continue;
    lengths.back().first = length_m;
    most = count;
  }
  return lengths;
}

std::string lengths_text(const BinLengths& lengths) {
  if (lengths.size() == 1) return length_text(lengths.front().first) + " m";
  std::string text;
  for (std::size_t i = 0; i < std::min(lengths.size(), kMaxListed); ++i) {
    text += fmt::format("{}{} m ({})", i == 0 ? "" : ", ", length_text(lengths[i].first),
                        counted(lengths[i].second, "beam"));
  }
  return lengths.size() > kMaxListed ? text + fmt::format(" and {} more", lengths.size() - kMaxListed) : text;
}

/// {"0.0125": 400}: beams by bin length.
JsonObject lengths_json(const BinLengths& lengths) {
  JsonObject json;
  for (std::size_t i = 0; i < std::min(lengths.size(), kMaxListed); ++i) {
    json.add(length_text(lengths[i].first), lengths[i].second);
  }
  return json;
}

/// Ascending numbers with ranges: "2-5, 8".
std::string numbers_text(const std::vector<std::size_t>& numbers) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t last = i;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    text += fmt::format("{}{}", text.empty() ? "" : ", ", numbers[i]);
    if (last > i) text += fmt::format("-{}", numbers[last]);
    i = last + 1;
  }
  return text;
}

class BeamSurvey {
 public:
  void add(const Beam& beam) {
    if (beams_++ == 0) first_s_ = last_s_ = beam.time_s;
    first_s_ = std::min(first_s_, beam.time_s);
    last_s_ = std::max(last_s_, beam.time_s);
    order_.add(beam.time_s);
    pauses_.add(beam.time_s);
    fewest_bins_ = std::min(fewest_bins_, beam.intensities.size());
    most_bins_ = std::max(most_bins_, beam.intensities.size());
    longest_m_ = std::max(longest_m_, static_cast<double>(beam.intensities.size()) * beam.bin_length_m);
    ++bin_lengths_[beam.bin_length_m];
    constexpr double kStep_rad = 1e-4 * kDegree_rad;
    bearings_rad_.insert(std::round(beam.bearing_rad / kStep_rad) * kStep_rad);
    take(assembler_.add(beam));
  }

  Summary finish(const std::string& name, Format format, const BeamSource& source) {
    const std::size_t skipped = source.skipped();
    take(assembler_.finish());
    // Most frequent first.
    BinLengths lengths = distinct_lengths(bin_lengths_);
    std::sort(lengths.begin(), lengths.end(),
              [](const auto& a, const auto& b) { return std::pair(b.second, a.first) < std::pair(a.second, b.first); });
    const std::size_t fewest = beams_ > 0 ? fewest_bins_ : 0;
    const double sector = sector_deg({bearings_rad_.begin(), bearings_rad_.end()}, has_turn_);
    Summary summary;
    JsonObject bins, threshold;
    if (thresholds_.min) {
      threshold.add("min", *thresholds_.min).add("max", *thresholds_.max);
    } else {
      threshold.add_null("min").add_null("max");
    }
    bins.add("min", fewest).add("max", most_bins_);
    summary.json.add("kind", "log")
        .add("format", name_of(format))
        .add("beams", beams_)
        .add("sweeps", complete_.size())
        .add("all_sweeps", sweeps_)
        .add("bins", bins)
        .add("bin_length_m", beams_ > 0 ? lengths.front().first : std::numeric_limits<double>::quiet_NaN())
        .add("bin_lengths", lengths_json(lengths))
        .add("duration_s", last_s_ - first_s_)
        .add("pauses", pauses_json(pauses_.pauses()))
        .add("clock", name_of(source.clock()))
        .add("late", order_.late())
        .add("sector_deg", sector)
        .add("echoes", echoes_)
        .add("threshold", threshold)
        .add("skipped", skipped);
    summary.text =
        headline(name, format) + report_line("beams", fmt::format("{}", beams_)) + report_line("sweeps", sweeps_text());
    if (beams_ > 0) {
      summary.text += report_line("bins", fewest == most_bins_ ? fmt::format("{} per beam", fewest)
                                                               : fmt::format("{} to {} per beam", fewest, most_bins_)) +
                      report_line("bin length", lengths_text(lengths)) +
                      report_line("range", fmt::format("{:.6g} m", longest_m_)) +
                      report_line("sector", fmt::format("{:.6g} degrees", sector)) +
                      report_line("duration", beam_duration_text(source.clock())) + pauses_line() + order_text() +
                      report_line("echoes", fmt::format("{}, threshold {}", echoes_, thresholds_.text(std::nullopt)));
    }
    if (const DeviceProfile* device = source.device()) {
      add_device(summary, *device, format);
    } else {
      const BeamModelOptions assumed;
      summary.text +=
          report_line("device", fmt::format("not named: a beam of {:.6g} x {:.6g} degrees is assumed (--device)",
                                            rounded_degrees(assumed.width_rad), rounded_degrees(assumed.height_rad)));
    }
    if (const std::string note = source.note(); !note.empty()) {
      summary.json.add("note", note);
      summary.text += report_line("note", on_one_line(note));
    }
    if (skipped > 0) summary.text += skipped_line(source);
    add_damage(summary, source.damage());
    return summary;
  }

 private:
  std::string sweeps_text() const {
    if (sweeps_ == 0) return "0";
    if (complete_.size() == sweeps_) return fmt::format("{}, all complete", sweeps_);
    if (complete_.empty()) return fmt::format("{}, none complete", sweeps_);
    return fmt::format("{}, complete: {}", sweeps_, numbers_text(complete_));
  }

  std::string pauses_line() const {
    const BeamPauses pauses = pauses_.pauses();
    if (pauses.count == 0) return "";
    return report_line("pauses", pauses_text(pauses) + ": the head stood still, or beams were lost");
  }

  std::string beam_duration_text(BeamClock clock) const {
    if (clock == BeamClock::kNone) return "not known: the log has no times";
    const std::string text = duration_text(first_s_, last_s_);
    if (clock == BeamClock::kTimeOfDay) return text + " of the day";
    if (first_s_ < kFirstDate_s && last_s_ >= kFirstDate_s) {
      return fmt::format("{} to {}: its clock was not set all the time", text, date_text(last_s_));
    }
    return date_text(first_s_).empty() ? text : text + " by its clock";
  }

  /// Of beams that came after later ones.
  std::string order_text() const {
    if (const std::optional<ClockStep> step = order_.step_back()) {
      return report_line("clock back",
                         fmt::format("by {:.3f} s, from {:.3f} to {:.3f} s; {} late", step->from_s - step->to_s,
                                     step->from_s, step->to_s, counted(step->late, "beam")));
    }
    if (order_.late() == 0) return "";
    return report_line("late", counted(order_.late(), "beam") + " behind a later one: messages were swapped");
  }

  void take(const std::optional<Sweep>& sweep) {
    if (!sweep) return;
    ++sweeps_;
    const auto echoes = detect_echoes(apply_filter(PolarImage(*sweep), FilterOptions{}), *sweep, EchoOptions{});
    echoes_ +=
        static_cast<std::size_t>(std::ranges::count_if(echoes, [](const auto& echo) { return echo.has_value(); }));
    thresholds_.add(echoes);
    if (sweep->extent == Sweep::Extent::kCut) return;
    complete_.push_back(sweeps_);
    has_turn_ = has_turn_ || sweep->extent == Sweep::Extent::kTurn;
  }

  std::size_t beams_ = 0, sweeps_ = 0, echoes_ = 0;
  std::vector<std::size_t> complete_;  ///< numbers of the complete sweeps, from 1
  ThresholdRange thresholds_;
  std::size_t fewest_bins_ = std::numeric_limits<std::size_t>::max(), most_bins_ = 0;
  double first_s_ = 0.0, last_s_ = 0.0, longest_m_ = 0.0;
  BeamPauseCounter pauses_;
  bool has_turn_ = false;
  std::map<double, std::size_t> bin_lengths_;
  TimeOrder order_;
  std::set<double> bearings_rad_;  ///< rounded: their number is bounded, however long the log
  SweepAssembler assembler_;
};

}  // namespace

Result<Summary> summarize_beams(BeamSource& source, const std::string& name, Format format) {
  BeamSurvey survey;
  for (;;) {
    const Result<std::optional<Beam>> beam = source.next();
    if (!beam) return tl::unexpected(beam.error());
    if (!*beam) return survey.finish(name, format, source);
    survey.add(**beam);
  }
}

}  // namespace pingvox::app
