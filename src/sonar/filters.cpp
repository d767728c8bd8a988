#include "pingvox/sonar/filters.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <climits>
#include <new>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "base/option_errors.hpp"
#include "sonar/internal/option_limits.hpp"

namespace pingvox {
namespace {

/// The row of the image that stands `offset` rows behind its first one; nullopt: outside.
std::optional<std::size_t> row_at(const PolarImage& image, std::ptrdiff_t offset) {
  const auto rows = static_cast<std::ptrdiff_t>(image.rows());
  if (image.wrap() == PolarImage::Wrap::kAround) return static_cast<std::size_t>(((offset % rows) + rows) % rows);
  if (offset < 0 || offset >= rows) return std::nullopt;
  return static_cast<std::size_t>(offset);
}

/// Fills the bins that row `n` lacks: from the nearest row within `reach` that has them, else with its own last bin.
void fill_row(const PolarImage& image, std::size_t n, std::ptrdiff_t reach, std::span<std::uint8_t> filled) {
  std::size_t known = image.bins_in(n);
  for (std::ptrdiff_t distance = 1; distance <= reach && known < image.columns(); ++distance) {
    for (const std::ptrdiff_t side : {-distance, distance}) {
      const std::optional<std::size_t> other = row_at(image, static_cast<std::ptrdiff_t>(n) + side);
      if (!other || image.bins_in(*other) <= known) continue;
      const std::size_t end = image.bins_in(*other);
      std::ranges::copy(image.row(*other).subspan(known, end - known),
                        filled.begin() + static_cast<std::ptrdiff_t>(known));
      known = end;
    }
  }
  const std::uint8_t last = known > 0 ? filled[known - 1] : std::uint8_t{0};
  std::ranges::fill(filled.subspan(known), last);
}

/// The image with `margin` more rows at either end: from across the seam, or the outermost row repeated.
cv::Mat pad_rows(const PolarImage& image, int margin) {
  cv::Mat out(static_cast<int>(image.rows()) + 2 * margin, static_cast<int>(image.columns()), CV_8U);
  const auto row_of = [&out, &image](int n) { return std::span(out.ptr<std::uint8_t>(n), image.columns()); };
  for (int n = 0; n < static_cast<int>(image.rows()); ++n) {
    const auto row = static_cast<std::size_t>(n);
    std::ranges::copy(image.row(row), row_of(n + margin).begin());
    if (image.bins_in(row) < image.columns()) fill_row(image, row, margin, row_of(n + margin));
  }
  for (int n = 0; n < margin; ++n) {
    for (const int row : {n, margin + static_cast<int>(image.rows()) + n}) {
      const std::optional<std::size_t> source = row_at(image, row - margin);
      const int outermost = row < margin ? margin : margin + static_cast<int>(image.rows()) - 1;
      const int from = source ? static_cast<int>(*source) + margin : outermost;
      std::ranges::copy(row_of(from), row_of(row).begin());
    }
  }
  return out;
}

cv::Mat smooth(const cv::Mat& source, const FilterOptions& options) {
  const cv::Size window(options.kernel, options.kernel);
  cv::Mat out;
  switch (options.filter) {
    case Filter::kNone:
      return source;
    case Filter::kMean:
      cv::blur(source, out, window, cv::Point(-1, -1), cv::BORDER_REPLICATE);
      break;
    case Filter::kMedian:
      cv::medianBlur(source, out, options.kernel);  // its only border mode repeats the outermost value
      break;
    case Filter::kGaussian:
      cv::GaussianBlur(source, out, window, options.sigma, options.sigma, cv::BORDER_REPLICATE);
      break;
  }
  return out;
}

PolarImage smooth(const PolarImage& image, const FilterOptions& options) {
  const int margin = options.kernel / 2;
  const cv::Mat smoothed = smooth(pad_rows(image, margin), options);
  PolarImage out = image;
  for (std::size_t n = 0; n < out.rows(); ++n) {
    const auto* row = smoothed.ptr<std::uint8_t>(static_cast<int>(n) + margin);
    std::copy_n(row, out.bins_in(n), out.row(n).begin());  // 0 beyond the end of a beam
  }
  return out;
}

}  // namespace

Result<void> FilterOptions::validate() const {
  OptionErrors errors;
  errors.require(kFilterKernels.contain(kernel) && kernel % 2 == 1, "kernel", "odd, " + kFilterKernels.text(), kernel);
  errors.require("sigma", sigma, kFilterSigmas);
  return errors.result("filter");
}

PolarImage apply_filter(const PolarImage& image, const FilterOptions& options) {
  assert(options.validate());
  const bool fits = image.rows() < INT_MAX / 2 && image.columns() < INT_MAX;  // OpenCV counts in int
  assert(fits);
  if (options.filter == Filter::kNone || image.rows() == 0 || image.columns() == 0 || !fits) return image;
  try {
    return smooth(image, options);
  } catch (const cv::Exception& thrown) {
    if (thrown.code == cv::Error::StsNoMem) throw std::bad_alloc();
    throw;
  }
}

std::size_t reach_beams(const FilterOptions& options) {
  return options.filter == Filter::kNone ? 0 : 2 * static_cast<std::size_t>(options.kernel / 2);
}

}  // namespace pingvox
