#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "pingvox/geometry/pose.hpp"
#include "pingvox/geometry/raster.hpp"
#include "pingvox/limits.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"
#include "pingvox/sonar/detect_echo.hpp"

namespace pingvox {

/// What a pixel has where beams overlap.
enum class Blend {
  kMean,     ///< their mean; the weight of a beam falls from its axis to its edge
  kMaximum,  ///< the strongest
};

struct MosaicOptions {
  static constexpr Limits kResolutions_m{0.0, 1000.0, Limits::Ends::kLowOut};

  double resolution_m = 0.05;  ///< edge of a pixel
  Blend blend = Blend::kMean;
  double min_range_m = EchoOptions::kDefaultBlanking_m;          ///< bins nearer are left out: the transducer ringing
  double max_range_m = std::numeric_limits<double>::infinity();  ///< bins farther are left out

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// How wide and high a beam is drawn.
struct BeamExtent {
  double width_rad = 0.0, height_rad = 0.0;       ///< full angles
  std::optional<double> step_rad = std::nullopt;  ///< from the beam before it to this one, >= 0: leaves no gap there
};

/// The beams of a moving head as one picture of the ground, in the map frame.
///
/// The height of an echo within its beam is not observable. Each bin is drawn where an echo at the height of the
/// head comes from: as far from the head, horizontally, as its slant range. Where the head is so tilted that its beam
/// does not reach that height, it is drawn as if the echo came from the edge of the beam that is nearest to it.
class Mosaic {
 public:
  /// The most pixels of the picture.
  static constexpr std::size_t kMaxPixels = std::size_t{1} << 26;

  /// @return kBadOption when the options do not validate
  static Result<Mosaic> make(const MosaicOptions& options);

  /// Draws a beam.
  /// @param map_from_head  at its time
  /// @return kLimit when there would be more than kMaxPixels, with their number; kNoMemory. Nothing is drawn then.
  Result<void> add(const Pose& map_from_head, const Beam& beam, const BeamExtent& extent);

  /// Nothing was drawn.
  bool empty() const { return tiles_.empty(); }
  /// Intensities, 0..255; NaN where there is no beam.
  /// @return kUnsupported when nothing was drawn; kNoMemory
  Result<Raster<float>> picture() const;

 private:
  /// A range of pixels, both ends included.
  struct PixelRange {
    std::int64_t min = std::numeric_limits<std::int64_t>::max(), max = std::numeric_limits<std::int64_t>::min();

    void add(std::int64_t pixel);
    double count() const { return min > max ? 0.0 : static_cast<double>(max - min) + 1.0; }
  };
  struct PixelBox {
    PixelRange x, y;
  };
  /// Of a mean the sum of intensities and that of their weights; else the greatest intensity, with any weight.
  struct Pixel {
    float intensity = 0.0F, weight = 0.0F;
  };
  using Tile = std::vector<Pixel>;
  struct Wedge;

  explicit Mosaic(const MosaicOptions& options) : options_(options) {}

  Result<void> check_size(const PixelBox& heard) const;
  std::vector<float> intensities_by_range(const Beam& beam, double step_m, double ground_per_slant) const;
  void draw(const Wedge& wedge, const PixelBox& box);
  Pixel& pixel_at(std::int64_t x, std::int64_t y);

  MosaicOptions options_;
  PixelBox heard_;
  std::unordered_map<std::uint64_t, Tile> tiles_;
};

}  // namespace pingvox
