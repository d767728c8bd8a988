#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "pingvox/result.hpp"
#include "pingvox/sonar/filters.hpp"
#include "pingvox/sonar/polar_image.hpp"

namespace pingvox {

/// The detected return of one beam: the run of bins that it was found in.
struct Echo {
  std::size_t first = 0;  ///< bin where it was detected; of a near wall (Detector::kRise) maybe nearer than min_range_m
  std::size_t peak = 0;   ///< its strongest bin, the nearest of several
  std::size_t last = 0;   ///< its last bin
  double range_m = 0.0;   ///< estimated range of the wall from the transducer: one bin before the centre of the crest
  std::uint8_t intensity = 0;  ///< of the peak after filtering, 0..255
  int threshold = 0;           ///< that detected it: EchoOptions::threshold or its default
};

/// How the first bin of an echo is found. The rest is the same for all detectors:
/// - The echo ends at the last bin before the beam has fallen by more than half the contrast below its peak.
/// - Its range is the centre of its crest less one bin (the lag of a crest behind its wall), and at least the centre of
///   its first bin. The centre is the weighted mean of the unfiltered bins, smoothed along the beam only; the weight is
///   the height above (highest bin - contrast / 2).
/// - The contrast is the threshold of kRise, given or default; at most a given threshold of kLevel, kMax or kCfar.
enum class Detector {
  /// The first bin where the differences of successive bins (paper, section 8.2), summed since the last valley, reach
  /// the threshold. They are summed because a real wall rises over some ten bins (pulse, slanting beam, smoothing): no
  /// beam of the smoothed tank recording has a single difference of 70. A rise continues across dips of up to half the
  /// threshold below its top, so speckle does not split an echo, and a falling edge starts none.
  ///
  /// Where the blanking range ends within loud bins (the mean of the nine beams around is at the level of kLevel), that
  /// mean is searched first, from the transducer on. If it begins to rise at most 1.75 m behind the blanking range, its
  /// crest is beyond that range, and the beam is at that level there and has nothing louder behind, that is the echo. A
  /// crest within the blanking range, behind the ringing and not fainter than what follows, leaves the beam without an
  /// echo. If the mean does not rise, a rise of the beam alone from and within the loud bins is none, and the beam has
  /// an echo only if something behind them is as loud.
  kRise,
  /// The first bin that reaches the threshold. Ringing beyond the blanking range counts too.
  kLevel,
  /// The strongest bin, if it reaches the threshold. It may be multipath behind the wall.
  kMax,
  /// The first rising edge of the polar image (Canny 1986; paper, section 9), aperture 3: local maxima of the gradient
  /// |x| + |y| that exceed the threshold, and those above CannyOptions::low that are linked to one.
  kCanny,
  /// Constant false-alarm rate (Finn and Johnson 1968; smallest-of: Trunk 1978;
  /// greatest-of: Hansen and Sawyers 1980; ordered statistic: Rohling 1983): the
  /// first rising bin above the noise of the bins around it. For a gain that varies along the beam.
  kCfar,
};

struct CannyOptions {
  int low = 0;  ///< gradient that an edge linked to a strong one must exceed, 0..2040
  /// Maximum length of a link in steps to a neighbouring beam or bin, 1..6400. OpenCV's is unlimited; a limit lets
  /// echoes be detected while the head turns.
  std::size_t link = 8;
};

struct CfarOptions {
  enum class Noise {
    kCellAveraging,  ///< mean of all training bins
    kSmallestOf,     ///< the smaller of the means before and after: a second wall close by does not hide the first
    kGreatestOf,     ///< the greater of the two: fewer false echoes where the noise rises along the beam
    kOrdered,        ///< upper quartile of the training bins: insensitive to single bright ones
  };
  Noise noise = Noise::kSmallestOf;
  std::size_t guard = 16;     ///< bins on either side that may belong to the echo itself, 0..1000
  std::size_t training = 24;  ///< bins on either side, beyond the guard bins, that the noise is estimated from, 1..1000
  /// Fraction of bins of Rayleigh noise that pass, in (0, 0.5]. Exact for independent bins; lower for smoothed ones,
  /// and approximate at the ends of a beam, where training bins are missing.
  double false_alarm_rate = 1e-3;
  std::optional<double> scale = std::nullopt;  ///< replaces the rate: ratio of echo to noise, >= 1
};

struct EchoOptions {
  Detector detector = Detector::kRise;
  /// Blanking range: nearer bins hold the ringing transducer and the vehicle. nullopt: measured in each sweep
  /// (blanking_range_m), and farther where nearly all directions of a turn have an echo at the same range, up to 1.5 m.
  std::optional<double> min_range_m = kDefaultBlanking_m;
  std::size_t min_bin = 0;  ///< the same in bins; the farther of both applies
  /// Echoes are searched up to this range. Bins beyond it still set the default threshold: otherwise, with the wall cut
  /// off, faint clutter would become echoes.
  double max_range_m = std::numeric_limits<double>::infinity();
  /// kRise: minimum height of a rise, 1..255. kLevel, kMax: minimum intensity, 1..255. kCanny: gradient that a strong
  /// edge must exceed, 1..2040. kCfar: minimum height above the noise around, 1..255.
  /// nullopt: automatic, from the contrast of the 33 beams around. kRise: half of the upper quartile of their largest
  /// rises within 48 bins (70 in the tank recording); where they are mostly noise, 15 times the noise; and where no
  /// beam around has a wall at about that range, at least 12 times the noise there. kLevel, kMax:
  /// the lower quartile of the beam plus that. kCanny: 1.6 times that. kCfar: that.
  std::optional<int> threshold = std::nullopt;
  CannyOptions canny = {};
  CfarOptions cfar = {};

  static constexpr double kDefaultBlanking_m = 0.75;

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// The first echo of each beam (paper, section 8.2), one per row of the image; nullopt, not maximum range, if there is
/// none. Range and peak of an echo come from bins that lie entirely beyond the minimum range; nearer ones only
/// determine where a near wall begins (kRise). No echo has bins beyond max_range_m.
/// @param image  the sweep's image, filtered or not
/// @param sweep  the sweep that the image was made of
/// REQUIRES valid options, image.rows() == sweep.beams.size()
std::vector<std::optional<Echo>> detect_echoes(const PolarImage& image, const Sweep& sweep, const EchoOptions& options);

/// That of one beam alone, with less work. REQUIRES beam < image.rows() as well.
std::optional<Echo> detect_echo(const PolarImage& image, const Sweep& sweep, std::size_t beam,
                                const EchoOptions& options);

/// All echoes of each beam, the nearest first: the next one begins behind the last bin of the one before. What comes
/// behind the first is another wall within the beam's height, or multipath. kCanny finds the first alone.
/// @see detect_echoes
std::vector<std::vector<Echo>> detect_all_echoes(const PolarImage& image, const Sweep& sweep,
                                                 const EchoOptions& options);

/// Default filter of a detector, a Gaussian: kernel 11 and sigma 2.3 for Canny, as in the paper, else 5 and 1.
FilterOptions default_filter(Detector detector);

/// Beams of the filtered image to either side that affect one beam's echo. nullopt: the whole sweep, because its
/// blanking range is measured.
std::optional<std::size_t> reach_beams(const EchoOptions& options);

}  // namespace pingvox
