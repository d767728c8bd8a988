#include "sweep_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bitset>
#include <cmath>
#include <numbers>
#include <span>

#include "base/words.hpp"
#include "pingvox/sonar/filters.hpp"
#include "pingvox/sonar/polar_image.hpp"
#include "pingvox/viewer/render_cartesian.hpp"
#include "pingvox/viewer/render_echoes.hpp"
#include "threshold_range.hpp"

namespace pingvox::app {
namespace {

/// A sweep with its echoes.
struct ProcessedSweep {
  std::size_t number = 0;  ///< counted from 1
  Sweep sweep;
  PolarImage image;                           ///< the image to be shown
  std::vector<std::optional<Echo>> echoes{};  ///< empty when they are not marked
};

/// Keeps the bins of a beam that begin within a range.
void cut_beam(Beam& beam, double range_m) {
  const double bins = std::ceil(range_m / beam.bin_length_m);
  if (bins < static_cast<double>(beam.intensities.size())) {
    beam.intensities.resize(std::max<std::size_t>(static_cast<std::size_t>(bins), 1));
  }
}

ProcessedSweep process_sweep(std::size_t number, Sweep sweep, const PanelCommand& panel) {
  const PolarImage raw(sweep);
  const PolarImage smooth = apply_filter(raw, panel.build.filter);
  std::vector<std::optional<Echo>> echoes;
  if (panel.marks == EchoMarks::kOn) {
    echoes = detect_echoes(smooth, sweep, panel.build.echo);
  }
  for (std::size_t i = 0; i < sweep.beams.size(); ++i) {
    Beam& beam = sweep.beams[i];
    if (panel.image == ShownImage::kFiltered) {
      const auto row = smooth.row(i);
      beam.intensities.assign(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(smooth.bins_in(i)));
    }
    cut_beam(beam, panel.build.echo.max_range_m);
  }
  PolarImage image(sweep);
  return {number, std::move(sweep), std::move(image), std::move(echoes)};
}

std::string count_text(std::size_t beams, std::span<const std::optional<Echo>> echoes, const PanelCommand& panel,
                       std::size_t skipped) {
  std::size_t found = 0;
  for (const auto& echo : echoes) found += echo ? 1 : 0;
  std::string text = fmt::format("{} beams", beams);
  if (panel.marks == EchoMarks::kOn) {
    text += fmt::format(" with {} echoes", found);
    ThresholdRange thresholds;
    thresholds.add(echoes);
    if (found > 0) text += fmt::format(", threshold {}", thresholds.text(panel.build.echo.threshold));
  }
  if (skipped > 0) text += fmt::format("; skipped {}", counted(skipped, "damaged record"));
  return text;
}

double longest_range_m(std::span<const Beam> beams) {
  double longest_m = 0.0;
  for (const Beam& beam : beams) {
    longest_m = std::max(longest_m, static_cast<double>(beam.intensities.size()) * beam.bin_length_m);
  }
  return longest_m;
}

/// Where nearly all echoes fill less than half of the picture: the range that shows them larger. nullopt: all of it,
/// also where the range is asked for.
std::optional<double> zoomed_range_m(std::span<const Beam> beams, std::span<const std::optional<Echo>> echoes,
                                     const PanelCommand& panel) {
  if (std::isfinite(panel.build.echo.max_range_m)) return std::nullopt;
  std::vector<double> ranges_m;
  for (const auto& echo : echoes) {
    if (echo) ranges_m.push_back(echo->range_m);
  }
  if (ranges_m.empty()) return std::nullopt;
  // A single echo far away must not count.
  const auto last = ranges_m.begin() + static_cast<std::ptrdiff_t>((ranges_m.size() - 1) * 99 / 100);
  std::ranges::nth_element(ranges_m, last);
  const double wanted_m = std::ceil(1.2 * *last);
  return 2.0 * wanted_m < longest_range_m(beams) ? std::optional(wanted_m) : std::nullopt;
}

/// "; drawn to 5 m of 50 m, where nearly all echoes are (--max-range 50 draws all)"
std::string zoom_text(double drawn_m, double longest_m) {
  return fmt::format("; drawn to {:g} m of {:.3g} m, where nearly all echoes are (--max-range {:g} draws all)", drawn_m,
                     longest_m, std::ceil(longest_m));
}

/// Shortens beams, and removes the echoes beyond.
void cut_beams(std::vector<Beam>& beams, std::vector<std::optional<Echo>>& echoes, double range_m) {
  for (Beam& beam : beams) cut_beam(beam, range_m);
  for (auto& echo : echoes) {
    if (echo && echo->range_m > range_m) echo.reset();
  }
}

/// Number of whole degrees in which the sweep has a beam.
std::size_t directions_in(const Sweep& sweep) {
  std::bitset<360> seen;
  for (const Beam& beam : sweep.beams) {
    seen.set(static_cast<std::size_t>(beam.bearing_rad / std::numbers::pi * 180.0) % seen.size());
  }
  return seen.count();
}

}  // namespace

void PolarCollector::add(std::size_t number, Sweep sweep) {
  if (panel_.sweep && *panel_.sweep != number) return;
  ProcessedSweep next = process_sweep(number, std::move(sweep), panel_);
  beams_.insert(beams_.end(), next.sweep.beams.begin(), next.sweep.beams.end());
  echoes_.insert(echoes_.end(), next.echoes.begin(), next.echoes.end());
}

std::optional<Drawn> PolarCollector::draw(std::size_t skipped) {
  if (beams_.empty()) return std::nullopt;
  std::string what = count_text(beams_.size(), echoes_, panel_, skipped);
  if (const auto zoomed_m = zoomed_range_m(beams_, echoes_, panel_)) {
    what += zoom_text(*zoomed_m, longest_range_m(beams_));
    cut_beams(beams_, echoes_, *zoomed_m);
  }
  return Drawn{render_echoes(beams_, echoes_, panel_.echo_picture), what};
}

void CartesianCollector::add(std::size_t number, Sweep sweep) {
  if (panel_.sweep && *panel_.sweep != number) return;
  const auto fullness =
      std::pair(static_cast<double>(directions_in(sweep)) * longest_range_m(sweep.beams), sweep.beams.size());
  if (chosen_ && fullness <= fullness_) return;
  fullness_ = fullness;
  chosen_ = std::pair(number, std::move(sweep));
}

std::optional<Drawn> CartesianCollector::draw(std::size_t skipped) const {
  if (!chosen_) return std::nullopt;
  ProcessedSweep shown = process_sweep(chosen_->first, chosen_->second, panel_);
  std::vector<Beam>& beams = shown.sweep.beams;
  std::string what = fmt::format("sweep {}, {}", shown.number, count_text(beams.size(), shown.echoes, panel_, skipped));
  if (const auto zoomed_m = zoomed_range_m(beams, shown.echoes, panel_)) {
    what += zoom_text(*zoomed_m, longest_range_m(beams));
    cut_beams(beams, shown.echoes, *zoomed_m);
    shown.image = PolarImage(shown.sweep);
  }
  const CartesianPictureOptions options{panel_.echo_picture, panel_.between, panel_.build.model.width_rad};
  return Drawn{render_cartesian(shown.sweep, shown.image, shown.echoes, options), what};
}

}  // namespace pingvox::app
