#include "pingvox/sonar/detect_echo.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <span>

#include "base/option_errors.hpp"
#include "sonar/beam_rises.hpp"
#include "sonar/bin_window.hpp"
#include "sonar/canny.hpp"
#include "sonar/cfar.hpp"
#include "sonar/contrast.hpp"
#include "sonar/internal/blanking.hpp"
#include "sonar/internal/option_limits.hpp"
#include "sonar/near_field.hpp"
#include "sonar/noise_floor.hpp"
#include "sonar/ringing_arc.hpp"

namespace pingvox {
namespace {

using Bins = std::span<const std::uint8_t>;

/// Whether an echo with its peak at `top` has ended before bin i.
bool has_ended(Bins bins, std::size_t top, std::size_t i, int contrast) {
  return 2 * (bins[top] - bins[i]) > contrast;
}

/// Lag of the centre of a crest behind the wall [bins]: the pulse rises before its maximum, and the parts of a wall
/// beside its nearest point arrive later. 1.4 to 1.5 bins in the simulated tank and harbour, 0.9 in the tank
/// recording.
constexpr double kCrestLag_bins = 1.0;

/// Position of the wall [bins]: the centre of the echo's crest less its lag (see Detector). Unfiltered bins smoothed
/// along the beam only, because a window across beams moves slanting walls. An echo without a crest is at its first
/// bin.
double wall_of(Bins heard, const Echo& echo, int contrast) {
  constexpr std::array<int, 5> kPulse = {1, 4, 6, 4, 1};  // a Gaussian of sigma 1
  constexpr int kSum = 16;
  const auto smoothed = [&](std::size_t bin) {
    int sum = 0;
    for (std::size_t i = 0; i < kPulse.size(); ++i) {
      sum += kPulse[i] * heard[std::clamp(bin + i, echo.first + 2, echo.last + 2) - 2];
    }
    return sum;
  };
  int highest = 0;
  for (std::size_t bin = echo.first; bin <= echo.last; ++bin) highest = std::max(highest, smoothed(bin));
  double weights = 0.0, moment = 0.0;
  for (std::size_t bin = echo.first; bin <= echo.last; ++bin) {
    const double weight = std::max(0, contrast * kSum / 2 - (highest - smoothed(bin)));
    weights += weight;
    moment += weight * (static_cast<double>(bin) + 0.5);
  }
  return std::max(moment / weights - kCrestLag_bins, static_cast<double>(echo.first) + 0.5);
}

/// The echo that begins at `first`, without its range.
Echo echo_from(Bins bins, BinWindow window, std::size_t first, int contrast) {
  Echo echo{.first = first, .peak = first, .last = first};
  for (std::size_t i = first + 1; i < window.end && !has_ended(bins, echo.peak, i, contrast); ++i) {
    if (bins[i] > bins[echo.peak]) echo.peak = i;
    echo.last = i;
  }
  return echo;
}

/// @param floor    that a rise has to reach, too; nullptr: none
/// @param longest  maximum length of a rise [bins]
std::optional<std::size_t> first_rise(Bins bins, BinWindow window, int threshold, const NoiseFloor* floor,
                                      std::size_t longest) {
  // The sum of the differences since the valley is the height above it.
  std::size_t valley = window.begin;
  std::size_t top = window.begin;
  for (std::size_t i = window.begin + 1; i < window.end; ++i) {
    if (i - valley > longest) {
      const auto recent = bins.subspan(i - longest, longest);
      valley = i - longest + static_cast<std::size_t>(std::ranges::min_element(recent) - recent.begin());
    }
    const int rise = bins[i] - bins[valley];
    if (rise >= threshold && (floor == nullptr || rise >= floor->at(i))) return i;
    if (bins[i] <= bins[valley] || has_ended(bins, top, i, threshold)) {
      valley = top = i;
    } else if (bins[i] > bins[top]) {
      top = i;
    }
  }
  return std::nullopt;
}

/// Level above the beam's background: its lower quartile plus the contrast. REQUIRES a window that is not empty.
int default_level(Bins bins, BinWindow window, int contrast) {
  const Bins seen = bins.subspan(window.begin, window.end - window.begin);
  std::vector<std::uint8_t> values(seen.begin(), seen.end());
  const auto quartile = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 4);
  std::ranges::nth_element(values, quartile);
  return *quartile + contrast;
}

std::optional<std::size_t> first_at_level(Bins bins, BinWindow window, int level) {
  for (std::size_t i = window.begin; i < window.end; ++i) {
    if (bins[i] >= level) return i;
  }
  return std::nullopt;
}

/// Where the echo of the strongest bin begins.
std::optional<std::size_t> start_of_strongest(Bins bins, BinWindow window, int level, int contrast) {
  std::size_t peak = window.begin;
  for (std::size_t i = window.begin; i < window.end; ++i) {
    if (bins[i] > bins[peak]) peak = i;
  }
  if (bins[peak] < level) return std::nullopt;
  std::size_t first = peak;
  while (first > window.begin && !has_ended(bins, peak, first - 1, contrast)) --first;
  return first;
}

/// Whether the contrast is a given threshold and does not depend on other beams.
bool has_given_contrast(const EchoOptions& options) {
  return options.detector == Detector::kRise && options.threshold;
}

/// The bins of one beam, and what makes an echo in them.
struct SearchedBeam {
  Bins bins;
  BinWindow heard, searched;
  int contrast = 0;
  std::optional<NoiseFloor> floor = std::nullopt;  ///< kRise, without a given threshold
  std::optional<std::size_t> edge = std::nullopt;  ///< kCanny
};

/// What all beams of a sweep need for the search of their echoes.
class EchoSearch {
 public:
  /// Keeps references to all.
  EchoSearch(const PolarImage& image, const Sweep& sweep, const EchoOptions& options)
      : image_(image),
        sweep_(sweep),
        options_(options),
        heard_(windows_of(image, sweep, options)),
        searched_(clip_windows(options.max_range_m, heard_, sweep)) {
    if (!has_given_contrast(options)) contrasts_.emplace(image, heard_);
    if (options.detector == Detector::kRise && !options.threshold) floors_.emplace(image, heard_);
    if (options.detector == Detector::kCfar) scale_ = cfar_scale(options.cfar);
    if (options.detector != Detector::kCanny) return;
    std::vector<int> strong;
    for (std::size_t n = 0; n < image.rows(); ++n) strong.push_back(gradient_of(contrast_of(n)));
    edges_ = first_edges(image, searched_, strong, options.canny);
  }

  SearchedBeam beam(std::size_t n) const {
    return {.bins = image_.row(n).first(image_.bins_in(n)),
            .heard = heard_[n],
            .searched = searched_[n],
            .contrast = contrast_of(n),
            .floor = floors_ ? std::optional(floors_->of(n)) : std::nullopt,
            .edge = edges_.empty() ? std::nullopt : edges_[n]};
  }

  /// The threshold at the bin where an echo begins.
  int threshold_of(const SearchedBeam& beam, std::size_t first) const {
    const Detector detector = options_.detector;
    if (detector == Detector::kCanny) return gradient_of(beam.contrast);
    if (detector == Detector::kLevel || detector == Detector::kMax) return level_of(beam);
    if (options_.threshold) return *options_.threshold;
    return detector == Detector::kRise ? std::max(beam.contrast, beam.floor->at(first)) : beam.contrast;
  }

  /// The near field of a beam (kRise). nullopt: no bin is loud where the blanking range ends.
  std::optional<NearField> near_field(const SearchedBeam& beam, std::size_t n) const {
    const std::size_t nearest = beam.searched.begin;
    if (options_.detector != Detector::kRise || nearest >= beam.searched.end) return std::nullopt;
    const int loudness = mean_of_beams(image_, sweep_, n, nearest, nearest + 1).front();
    if (loudness < beam.contrast) return std::nullopt;  // no level is lower
    const int level = default_level(beam.bins, beam.heard, beam.contrast);
    if (loudness < level) return std::nullopt;
    return near_field_of(mean_of_beams(image_, sweep_, n, 0, beam.bins.size()), nearest, level,
                         sweep_.beams[n].bin_length_m);
  }

  /// Where the next rise of a beam's bins reaches its threshold (kRise).
  std::optional<std::size_t> rise_in(const SearchedBeam& beam, BinWindow window) const {
    // A given threshold may be reached over any number of bins.
    if (options_.threshold) return first_rise(beam.bins, window, beam.contrast, nullptr, beam.bins.size());
    return first_rise(beam.bins, window, beam.contrast, &*beam.floor, kRise_bins);
  }

  /// The same of the mean of the beams around, which has less noise.
  std::optional<std::size_t> rise_of_mean(Bins mean, const SearchedBeam& beam, BinWindow window) const {
    if (options_.threshold) return first_rise(mean, window, beam.contrast, nullptr, mean.size());
    const NoiseFloor floor = beam.floor->half();
    return first_rise(mean, window, beam.contrast, &floor, kRise_bins);
  }

  /// Where the next echo begins.
  /// @param window  part of the beam's bins that is searched. REQUIRES that it is not empty
  std::optional<std::size_t> first_in(const SearchedBeam& beam, BinWindow window) const {
    const Bins bins = beam.bins;
    switch (options_.detector) {
      case Detector::kRise:
        return rise_in(beam, window);
      case Detector::kLevel:
        return first_at_level(bins, window, level_of(beam));
      case Detector::kMax:
        return start_of_strongest(bins, window, level_of(beam), beam.contrast);
      case Detector::kCanny:
        // Only the first edge of a beam is known.
        return beam.edge && *beam.edge >= window.begin ? beam.edge : std::nullopt;
      case Detector::kCfar: {
        const double least = options_.threshold ? *options_.threshold : beam.contrast;
        const auto first =
            first_above_noise(bins.subspan(window.begin, window.end - window.begin), scale_, least, options_.cfar);
        if (first) return window.begin + *first;
        break;
      }
    }
    return std::nullopt;
  }

 private:
  int contrast_of(std::size_t n) const {
    if (!contrasts_) return *options_.threshold;
    const int contrast = contrasts_->of(n);
    return options_.threshold && options_.detector != Detector::kCanny ? std::min(contrast, *options_.threshold)
                                                                       : contrast;
  }

  int gradient_of(int contrast) const { return options_.threshold.value_or((8 * contrast + 2) / 5); }

  int level_of(const SearchedBeam& beam) const {
    return options_.threshold ? *options_.threshold : default_level(beam.bins, beam.heard, beam.contrast);
  }

  const PolarImage& image_;
  const Sweep& sweep_;
  const EchoOptions& options_;
  std::vector<BinWindow> heard_;     ///< bins that set contrast and noise floor
  std::vector<BinWindow> searched_;  ///< within those
  std::optional<Contrasts> contrasts_;
  std::optional<NoiseFloors> floors_;
  double scale_ = 0.0;                             ///< kCfar
  std::vector<std::optional<std::size_t>> edges_;  ///< kCanny
};

int loudest(Bins bins, std::size_t begin, std::size_t end) {
  return begin < end ? *std::ranges::max_element(bins.subspan(begin, end - begin)) : 0;
}

int quietest(Bins bins, std::size_t begin, std::size_t end) {
  return *std::ranges::min_element(bins.subspan(begin, end - begin));
}

/// The echo of the beams' mean that is heard where the blanking range ends or within the loud bins behind it: the last
/// one with its peak nearer, unless that has faded, or the first with its peak beyond.
std::optional<Echo> echo_of_mean(const EchoSearch& search, const SearchedBeam& beam, const NearField& near) {
  std::optional<Echo> nearer;
  BinWindow window{.begin = 0, .end = near.walls_end};
  while (const std::optional<std::size_t> first = search.rise_of_mean(near.mean, beam, window)) {
    const Echo echo = echo_from(near.mean, {.begin = window.begin, .end = beam.heard.end}, *first, beam.contrast);
    if (echo.peak >= beam.heard.begin) return echo;
    if (echo.peak >= near.begin) nearer = echo;
    window.begin = echo.last + 1;
  }
  return nearer;
}

/// The same echo in the beam's own bins: what the beam alone would find there, as others around may have longer echoes
/// that begin nearer; else, if too little of its rise is beyond the blanking range, from where the mean rises. nullopt:
/// the beam itself is fainter there than an echo.
std::optional<Echo> echo_of_beam(const EchoSearch& search, const SearchedBeam& beam, const NearField& near,
                                 const Echo& of_mean) {
  const std::size_t from = std::max(of_mean.first, beam.heard.begin);
  const Bins crest = beam.bins.subspan(from, of_mean.last + 1 - from);
  const std::size_t peak = from + static_cast<std::size_t>(std::ranges::max_element(crest) - crest.begin());
  if (beam.bins[peak] < std::max(near.level, search.threshold_of(beam, of_mean.first))) return std::nullopt;
  BinWindow window = beam.heard;
  while (window.begin <= peak) {
    const std::optional<std::size_t> first = search.rise_in(beam, window);
    if (!first || *first > peak) break;
    const Echo alone = echo_from(beam.bins, window, *first, beam.contrast);
    if (alone.last >= peak) return alone;
    window.begin = alone.last + 1;
  }
  Echo own = echo_from(beam.bins, beam.heard, peak, beam.contrast);
  own.first = of_mean.first;
  return own;
}

/// What a near field holds, and where the search for echoes goes on.
struct SearchedNearField {
  std::optional<Echo> wall;
  std::size_t search_from;
};

/// The mean of the beams around says what a loud near field is, as speckle differs from beam to beam:
/// - It rises to a crest beyond the blanking range, the beam itself is as loud there as an echo, and nothing behind is
///   louder: a near wall. What is behind a wall has lost more; what is louder has passed a part of the vehicle.
/// - Its crest is within the blanking range, but the ringing had ended before: something near, at an unknown range.
///   Unless something behind is louder, the beam says nothing.
/// - It only falls: ringing or reverberation. If the beam alone rises in it, that is speckle, and unless what comes
///   behind is as loud, it may be the second echo of a wall that the near field hides: the beam says nothing. A rise
///   from below the loud bins is not within them: there the beam itself is quiet before a wall.
SearchedNearField search_near_field(const EchoSearch& search, const SearchedBeam& beam, const NearField& near) {
  const BinWindow heard = beam.heard;
  const SearchedNearField nothing{.wall = std::nullopt, .search_from = heard.end};
  const SearchedNearField no_wall{.wall = std::nullopt, .search_from = heard.begin};
  const std::optional<Echo> echo = echo_of_mean(search, beam, near);
  if (echo && echo->peak >= heard.begin) {
    const std::optional<Echo> own = echo_of_beam(search, beam, near, *echo);
    if (!own || beam.bins[own->peak] < loudest(beam.bins, own->last + 1, heard.end)) return no_wall;
    return {.wall = own, .search_from = own->last + 1};
  }
  const int fainter = loudest(beam.bins, heard.begin, near.end) - loudest(beam.bins, near.end, heard.end);
  if (echo && near.begin >= near.ringing_end && fainter >= 0) return nothing;
  const std::optional<std::size_t> rise = search.rise_in(beam, heard);
  if (!rise || *rise >= near.end || quietest(beam.bins, heard.begin, *rise) < near.level) return no_wall;
  return 2 * fainter > beam.contrast ? nothing : SearchedNearField{.wall = std::nullopt, .search_from = near.end};
}

enum class Search { kStop, kContinue };

/// Calls f(echo) for the echoes of a beam, the nearest first, until it returns kStop. The next echo is searched for
/// behind the last bin of the one before.
template <class F>
void for_each_echo(const EchoSearch& search, const Sweep& sweep, std::size_t n, F&& f) {
  const SearchedBeam beam = search.beam(n);
  const auto report = [&](Echo echo) {
    echo.intensity = beam.bins[echo.peak];
    echo.threshold = search.threshold_of(beam, echo.first);
    Echo crest = echo;  // no bin within the blanking range sets a range
    crest.first = std::max(echo.first, beam.searched.begin);
    echo.range_m = wall_of(sweep.beams[n].intensities, crest, beam.contrast) * sweep.beams[n].bin_length_m;
    return f(echo);
  };
  BinWindow window = beam.searched;
  if (const std::optional<NearField> near = search.near_field(beam, n)) {
    SearchedNearField found = search_near_field(search, beam, *near);
    window.begin = found.search_from;
    if (found.wall && found.wall->peak < window.end) {
      found.wall->last = std::min(found.wall->last, window.end - 1);
      if (report(*found.wall) == Search::kStop) return;
    }
  }
  while (window.begin < window.end) {
    const std::optional<std::size_t> first = search.first_in(beam, window);
    if (!first) break;
    const Echo echo = echo_from(beam.bins, window, *first, beam.contrast);
    window.begin = echo.last + 1;
    if (report(echo) == Search::kStop) break;
  }
}

std::optional<Echo> first_echo(const EchoSearch& search, const Sweep& sweep, std::size_t n) {
  std::optional<Echo> found;
  for_each_echo(search, sweep, n, [&](const Echo& echo) {
    found = echo;
    return Search::kStop;
  });
  return found;
}

std::vector<std::optional<Echo>> first_echoes(const PolarImage& image, const Sweep& sweep, const EchoOptions& options) {
  const EchoSearch search(image, sweep, options);
  std::vector<std::optional<Echo>> first;
  first.reserve(image.rows());
  for (std::size_t n = 0; n < image.rows(); ++n) first.push_back(first_echo(search, sweep, n));
  return first;
}

/// The options with a minimum range: if none is given, the blanking range of the sweep, beyond its arcs of ringing.
EchoOptions with_min_range(const PolarImage& image, const Sweep& sweep, EchoOptions options) {
  if (options.min_range_m) return options;
  options.min_range_m = blanking_range_m(image, sweep);
  EchoOptions anywhere = options;
  anywhere.max_range_m = std::numeric_limits<double>::infinity();
  constexpr int kMaxArcs = 8;
  for (int arc = 0; arc < kMaxArcs; ++arc) {
    const std::optional<double> end_m = end_of_ringing_arc_m(first_echoes(image, sweep, anywhere), sweep);
    if (!end_m || *end_m <= *anywhere.min_range_m) break;
    anywhere.min_range_m = end_m;
  }
  options.min_range_m = anywhere.min_range_m;
  return options;
}

}  // namespace

Result<void> EchoOptions::validate() const {
  OptionErrors errors;
  const double nearest = min_range_m.value_or(0.0);
  errors.require("min_range_m", nearest, kNearestRanges_m);
  errors.require(max_range_m > nearest, "max_range_m", fmt::format("greater than min_range_m ({})", nearest),
                 max_range_m);
  const int most = detector == Detector::kCanny ? 2040 : 255;
  errors.require(!threshold || (*threshold >= 1 && *threshold <= most), "threshold", fmt::format("in 1..{}", most),
                 threshold.value_or(0));
  errors.require_within("canny.low", canny.low, 0, 2040);
  errors.require_within("canny.link", canny.link, 1, 6400);
  errors.require(cfar.guard <= 1000, "cfar.guard", "at most 1000", cfar.guard);
  errors.require_within("cfar.training", cfar.training, 1, 1000);
  errors.require(cfar.false_alarm_rate > 0.0 && cfar.false_alarm_rate <= 0.5, "cfar.false_alarm_rate",
                 "> 0 and at most 0.5", cfar.false_alarm_rate);
  const double scale = cfar.scale.value_or(1.0);
  errors.require(scale >= 1.0 && std::isfinite(scale), "cfar.scale", ">= 1", scale);
  return errors.result("echo");
}

std::vector<std::optional<Echo>> detect_echoes(const PolarImage& image, const Sweep& sweep,
                                               const EchoOptions& options) {
  assert(options.validate());
  assert(image.rows() == sweep.beams.size());
  return first_echoes(image, sweep, with_min_range(image, sweep, options));
}

std::optional<Echo> detect_echo(const PolarImage& image, const Sweep& sweep, std::size_t beam,
                                const EchoOptions& options) {
  assert(options.validate());
  assert(image.rows() == sweep.beams.size());
  assert(beam < image.rows());
  const EchoOptions measured = with_min_range(image, sweep, options);
  return first_echo(EchoSearch(image, sweep, measured), sweep, beam);
}

std::vector<std::vector<Echo>> detect_all_echoes(const PolarImage& image, const Sweep& sweep,
                                                 const EchoOptions& options) {
  assert(options.validate());
  assert(image.rows() == sweep.beams.size());
  const EchoOptions measured = with_min_range(image, sweep, options);
  const EchoSearch search(image, sweep, measured);
  std::vector<std::vector<Echo>> all(image.rows());
  for (std::size_t n = 0; n < image.rows(); ++n) {
    for_each_echo(search, sweep, n, [&](const Echo& echo) {
      all[n].push_back(echo);
      return Search::kContinue;
    });
  }
  return all;
}

FilterOptions default_filter(Detector detector) {
  FilterOptions filter;
  if (detector == Detector::kCanny) {
    filter.kernel = 11;
    filter.sigma = 2.3;
  }
  return filter;
}

std::optional<std::size_t> reach_beams(const EchoOptions& options) {
  if (!options.min_range_m) return std::nullopt;
  return (has_given_contrast(options) ? kNearFieldReach_beams : kContrastReach_beams) +
         (options.detector == Detector::kCanny ? canny_reach_beams(options.canny) : 0);
}

}  // namespace pingvox
