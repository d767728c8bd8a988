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
  std::size_t first = 0;       ///< bin where it was detected
  std::size_t peak = 0;        ///< its strongest bin (the nearest one of several)
  std::size_t last = 0;        ///< its last bin
  double range_m = 0.0;        ///< where we take the wall to be, from the transducer: a bin before the crest's middle
  std::uint8_t intensity = 0;  ///< of the peak, 0..255, as it was detected (after filtering)
  int threshold = 0;           ///< it was detected with: EchoOptions::threshold, or what that is by default
};

/// How an echo is found. Whatever finds its first bin, it runs from there to the last bin before the beam has fallen by
/// more than half the contrast below its peak. Its range is the middle of its crest, less the bin by which a crest lies
/// behind its wall: the mean of its bins as they were heard, smoothed along the beam only, weighted with what they
/// stand above half of the contrast below the highest; not before the middle of its first bin. The contrast is the
/// threshold of kRise, or what that would be by default; no more than a given threshold of kLevel, kMax or kCfar.
enum class Detector {
  /// Differences of successive bins, as in the paper (section 8.2), summed over a rise: a bin is an echo's first when
  /// the differences from bin to bin, added up since the last valley, reach the threshold. Without noise and smoothing
  /// a wall rises in one step, and the sum is that one difference. A real wall rises over some ten bins (pulse,
  /// slanting beam, smoothing): of the smoothed tank recording no beam has a single difference of 70, few one of 35.
  /// A rise, before and after it is detected, goes on across dips and ends where the beam has fallen by more than half
  /// the threshold below its top: speckle stays inside the echo, and a falling edge starts none.
  kRise,
  /// The first bin that reaches the threshold. What is left of the ringing behind the blanking range counts too.
  kLevel,
  /// The strongest bin, if it reaches the threshold. It may be a second echo behind the wall.
  kMax,
  /// The first rising edge of the polar image (Canny 1986; paper, section 9), aperture 3: local maxima of the gradient
  /// |x| + |y| that exceed the threshold, and those above CannyOptions::low that are linked to one.
  kCanny,
  /// Constant false-alarm rate (Finn and Johnson 1968; smallest-of: Trunk 1978; ordered statistic: Rohling 1983): the
  /// first rising bin that stands out from the bins around it. For a gain that varies along the beam.
  kCfar,
};

struct CannyOptions {
  int low = 0;  ///< gradient that an edge needs where it is linked to a strong one, 0..2040
  /// How many steps to a neighbouring beam or bin a link is long at most, 1..6400. OpenCV's has no end, and one far
  /// away decides; this one can be waited for while the head turns.
  std::size_t link = 8;
};

struct CfarOptions {
  enum class Noise {
    kCellAveraging,  ///< mean of all training bins
    kSmallestOf,     ///< the smaller of the means before and behind: a second wall close by hides nothing
    kOrdered,        ///< the training bin that three quarters of them do not exceed: single bright ones do not matter
  };
  Noise noise = Noise::kSmallestOf;
  std::size_t guard = 16;     ///< bins on either side that may belong to the echo itself, 0..1000
  std::size_t training = 24;  ///< bins on either side, behind those, that show the noise, 1..1000
  /// Share of bins of Rayleigh noise that would pass, in (0, 0.5]. Exact for independent bins; smoothed ones pass
  /// more seldom, and at the ends of the beam there are fewer to train on.
  double false_alarm_rate = 1e-3;
  std::optional<double> scale = std::nullopt;  ///< instead of the rate: how many times the noise an echo must be, >= 1
};

struct EchoOptions {
  Detector detector = Detector::kRise;
  /// The blanking range: nearer bins are the vehicle and the ringing transducer. nullopt: found in each sweep
  /// (blanking_range_m).
  std::optional<double> min_range_m = kUsualBlanking_m;
  std::size_t min_bin = 0;  ///< the same in bins; the farther one of both counts
  /// Echoes are looked for up to here. What is heard farther away still tells the gain: without it a wall that is cut
  /// off leaves only what is faint, and that would become echoes.
  double max_range_m = std::numeric_limits<double>::infinity();
  /// kRise: the least sum of differences over a rise, 1..255. kLevel, kMax: the least intensity, 1..255. kCanny: the
  /// gradient that a strong edge exceeds, 1..2040. kCfar: how far above the noise around it an echo must stand, 1..255.
  /// nullopt: by the gain that the beam was heard with. kRise: half of the largest rise (within 48 bins) that is usual
  /// in the 33 beams around, 70 in the tank recording; where those are mostly noise, a rise of fifteen times the noise.
  /// kLevel, kMax: as much above the lower quartile of the beam. kCanny: 1.6 times, kCfar: as much.
  std::optional<int> threshold = std::nullopt;
  CannyOptions canny = {};
  CfarOptions cfar = {};

  static constexpr double kUsualBlanking_m = 0.75;

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// The first echo of each beam (paper, section 8.2): one per row of the image. No echo is none, not an echo at maximum
/// range; a falling edge is none either (but see kLevel). Only bins that lie beyond the minimum range as a whole are
/// evidence: what stands in others changes nothing. No echo has bins farther away than max_range_m.
/// @param image  the sweep's image, filtered or not
/// @param sweep  the sweep it was made of (each beam's own bin length turns its bins into metres)
/// REQUIRES valid options, image.rows() == sweep.beams.size()
std::vector<std::optional<Echo>> detect_echoes(const PolarImage& image, const Sweep& sweep, const EchoOptions& options);

/// The filter that goes with a detector where nothing else is asked for: 11 and 2.3 for Canny as in the paper, else 5
/// and 1.
FilterOptions usual_filter(Detector detector);

/// How many beams of the filtered image to either side decide about one beam's echo. nullopt: the whole sweep, because
/// its blanking range is to be found.
std::optional<std::size_t> reach_beams(const EchoOptions& options);

}  // namespace pingvox
