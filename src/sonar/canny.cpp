#include "sonar/canny.hpp"

#include <algorithm>
#include <cassert>
#include <climits>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <span>
#include <utility>

namespace pingvox {
namespace {

/// The image with `margin` more rows at either end: from across the seam, or the outermost row repeated. Bins outside
/// of the window get the value of the nearest bin inside, so that its border makes no edge.
class Rows {
 public:
  Rows(const PolarImage& image, const std::vector<BinWindow>& windows, std::size_t margin)
      : rows_(image.rows()), margin_(margin), around_(image.wrap() == PolarImage::Wrap::kAround) {
    pixels_ = cv::Mat(static_cast<int>(rows_ + 2 * margin), static_cast<int>(image.columns()), CV_8U);
    for (std::size_t at = 0; at < rows_ + 2 * margin; ++at) {
      const std::size_t n = source_of(at);
      const std::span out(pixels_.ptr<std::uint8_t>(static_cast<int>(at)), image.columns());
      const auto [begin, end] = windows[n];
      if (begin >= end) {
        std::ranges::fill(out, std::uint8_t{0});
        continue;
      }
      const std::span<const std::uint8_t> row = image.row(n);
      std::ranges::fill(out.first(begin), row[begin]);
      std::ranges::copy(row.subspan(begin, end - begin), out.begin() + static_cast<std::ptrdiff_t>(begin));
      std::ranges::fill(out.subspan(end), row[end - 1]);
    }
  }

  const cv::Mat& pixels() const { return pixels_; }
  std::size_t size() const { return rows_ + 2 * margin_; }

  /// Row of the image that is copied to row `at`.
  std::size_t source_of(std::size_t at) const {
    const auto rows = static_cast<std::ptrdiff_t>(rows_);
    const auto n = static_cast<std::ptrdiff_t>(at) - static_cast<std::ptrdiff_t>(margin_);
    return static_cast<std::size_t>(around_ ? (n % rows + rows) % rows : std::clamp(n, std::ptrdiff_t{0}, rows - 1));
  }

 private:
  std::size_t rows_;
  std::size_t margin_;
  bool around_;
  cv::Mat pixels_;
};

/// Hysteresis: strong edges, and weak ones linked to a strong one by at most `link` steps.
class Links {
 public:
  Links(std::size_t rows, std::size_t columns) : rows_(rows), columns_(columns), state_(rows * columns, kNoEdge) {}

  void add_weak(std::size_t row, std::size_t column) { state_[row * columns_ + column] = kWeak; }
  void add_strong(std::size_t row, std::size_t column) {
    state_[row * columns_ + column] = kCounts;
    front_.push_back(row * columns_ + column);
  }
  bool counts(std::size_t row, std::size_t column) const { return state_[row * columns_ + column] == kCounts; }

  void spread(std::size_t steps) {
    std::vector<std::size_t> next;
    for (; steps > 0 && !front_.empty(); --steps) {
      next.clear();
      for (const std::size_t place : front_) spread_from(place, next);
      std::swap(front_, next);
    }
  }

 private:
  enum : std::uint8_t { kNoEdge, kWeak, kCounts };

  void spread_from(std::size_t place, std::vector<std::size_t>& next) {
    const std::size_t row = place / columns_;
    const std::size_t column = place % columns_;
    for (std::size_t r = row - std::min<std::size_t>(row, 1); r <= std::min(row + 1, rows_ - 1); ++r) {
      for (std::size_t c = column - std::min<std::size_t>(column, 1); c <= std::min(column + 1, columns_ - 1); ++c) {
        if (state_[r * columns_ + c] != kWeak) continue;
        state_[r * columns_ + c] = kCounts;
        next.push_back(r * columns_ + c);
      }
    }
  }

  std::size_t rows_;
  std::size_t columns_;
  std::vector<std::uint8_t> state_;
  std::vector<std::size_t> front_;
};

Links edges_of(const Rows& rows, const std::vector<BinWindow>& windows, const std::vector<int>& strong,
               const CannyOptions& options) {
  cv::Mat along;
  cv::Mat across;
  cv::Mat thin;
  cv::Sobel(rows.pixels(), along, CV_16S, 1, 0, 3, 1.0, 0.0, cv::BORDER_REPLICATE);
  cv::Sobel(rows.pixels(), across, CV_16S, 0, 1, 3, 1.0, 0.0, cv::BORDER_REPLICATE);
  // Equal thresholds switch off the linking: all local maxima above the lower threshold remain.
  cv::Canny(along, across, thin, options.low, options.low, false);
  Links links(rows.size(), static_cast<std::size_t>(thin.cols));
  for (std::size_t at = 0; at < rows.size(); ++at) {
    const std::size_t n = rows.source_of(at);
    const auto* is_edge = thin.ptr<std::uint8_t>(static_cast<int>(at));
    const auto* rise = along.ptr<std::int16_t>(static_cast<int>(at));
    const auto* turn = across.ptr<std::int16_t>(static_cast<int>(at));
    for (std::size_t i = windows[n].begin; i < windows[n].end; ++i) {
      if (is_edge[i] == 0 || rise[i] <= 0) continue;
      if (rise[i] + std::abs(turn[i]) > strong[n]) {
        links.add_strong(at, i);
      } else {
        links.add_weak(at, i);
      }
    }
  }
  links.spread(options.link);
  return links;
}

}  // namespace

std::size_t canny_reach_beams(const CannyOptions& options) {
  return options.link + 2;
}

std::vector<std::optional<std::size_t>> first_edges(const PolarImage& image, const std::vector<BinWindow>& windows,
                                                    const std::vector<int>& strong, const CannyOptions& options) {
  std::vector<std::optional<std::size_t>> first(image.rows());
  const bool fits = image.rows() < INT_MAX / 4 && image.columns() < INT_MAX;  // OpenCV counts in int
  assert(fits);
  if (image.rows() == 0 || image.columns() == 0 || !fits) return first;
  const std::size_t margin = canny_reach_beams(options);
  try {
    const Links edges = edges_of(Rows(image, windows, margin), windows, strong, options);
    for (std::size_t n = 0; n < image.rows(); ++n) {
      for (std::size_t i = windows[n].begin; i < windows[n].end && !first[n]; ++i) {
        if (edges.counts(margin + n, i)) first[n] = i;
      }
    }
  } catch (const cv::Exception& thrown) {
    if (thrown.code == cv::Error::StsNoMem) throw std::bad_alloc();
    throw;
  }
  return first;
}

}  // namespace pingvox
