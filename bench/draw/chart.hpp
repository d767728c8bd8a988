#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "pingvox/result.hpp"
#include "pingvox/viewer/picture.hpp"
#include "viewer/axis.hpp"

namespace pingvox::bench {

/// A named series of numbers.
struct Series {
  std::string name;
  std::vector<double> y;
  std::vector<double> x{};  ///< of kLines: as many as y
};

/// A line or bar chart. Series differ in lightness and in the shape of their markers (bars: hatching), to be readable
/// without colour.
struct Chart {
  enum class Kind {
    kLines,  ///< a marker at each (x, y), joined in order; a number that an axis cannot show breaks the line
    kBars,   ///< a group for each category with a labelled bar for each series; they rise from 0, on a
             ///< logarithmic axis from its lower end
  };
  /// Number of distinct styles.
  static constexpr std::size_t kMaxSeries = 6;

  Kind kind = Kind::kLines;
  std::string title{}, x_label{}, y_label{};  ///< ASCII; x_label and y_label name their units
  Spacing x_spacing = Spacing::kLinear;       ///< of kLines
  Spacing y_spacing = Spacing::kLinear;
  std::vector<std::string> categories{};  ///< of kBars: one for each value of each series
  std::vector<Series> series{};
  std::optional<double> y_mark = std::nullopt;  ///< a dashed line across, for a reference value
  std::size_t width = 1000, height = 640;       ///< of the whole picture [px], 320..4096 and 240..4096

  /// kBadOption names every broken field at once: too many series, x and y or categories of different lengths, a
  /// logarithmic axis without any number above 0.
  Result<void> validate() const;
};

/// REQUIRES a valid chart. Numbers that are not finite, or not above 0 on a logarithmic axis, are omitted.
Picture render_chart(const Chart& chart);

}  // namespace pingvox::bench
