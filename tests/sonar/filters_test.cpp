#include "pingvox/sonar/filters.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace pingvox {
namespace {

using testing::AllOf;
using testing::Each;
using testing::HasSubstr;
using Wrap = PolarImage::Wrap;

constexpr std::array kFilters = {Filter::kMean, Filter::kMedian, Filter::kGaussian};

PolarImage random_image(std::mt19937_64& random, std::size_t rows, std::size_t columns, Wrap wrap) {
  PolarImage image(std::vector(rows, columns), columns, wrap);
  for (std::size_t n = 0; n < rows; ++n) {
    for (std::uint8_t& pixel : image.row(n)) pixel = static_cast<std::uint8_t>(random() % 256);
  }
  return image;
}

/// The definitions, written to be obviously right: a weighted mean, or the middle one, of the square window.
double smoothed_pixel(const PolarImage& image, int n, int i, const FilterOptions& options) {
  const int rows = static_cast<int>(image.rows());
  const int columns = static_cast<int>(image.columns());
  double sum = 0.0;
  double weights = 0.0;
  std::vector<std::uint8_t> window;
  for (int down = -(options.kernel / 2); down <= options.kernel / 2; ++down) {
    for (int right = -(options.kernel / 2); right <= options.kernel / 2; ++right) {
      const double gaussian = std::exp(-0.5 * (down * down + right * right) / (options.sigma * options.sigma));
      const double weight = options.filter == Filter::kGaussian ? gaussian : 1.0;
      const int row =
          image.wrap() == Wrap::kAround ? (((n + down) % rows) + rows) % rows : std::clamp(n + down, 0, rows - 1);
      const int column = std::clamp(i + right, 0, columns - 1);
      window.push_back(image.row(static_cast<std::size_t>(row))[static_cast<std::size_t>(column)]);
      sum += weight * window.back();
      weights += weight;
    }
  }
  if (options.filter != Filter::kMedian) return sum / weights;
  std::ranges::sort(window);
  return window[window.size() / 2];
}

/// How far a filter may be off the definition: fixed-point weights and rounding.
double tolerance_of(Filter filter) {
  switch (filter) {
    case Filter::kGaussian:
      return 1.5;
    case Filter::kMean:
      return 0.51;
    case Filter::kMedian:
    case Filter::kNone:
      break;
  }
  return 0.0;
}

TEST(ApplyFilter, EqualsItsDefinitionAlsoAcrossTheSeamAndInSmallImages) {
  std::size_t checked = 0;
  for (std::uint64_t seed = 1; seed <= 360; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const std::size_t rows = 1 + random() % 20;
    const std::size_t columns = 1 + random() % 20;
    const PolarImage image = random_image(random, rows, columns, seed / 3 % 2 == 0 ? Wrap::kAround : Wrap::kNone);
    const FilterOptions options{.filter = kFilters[seed % kFilters.size()],
                                .kernel = static_cast<int>(1 + 2 * (random() % 8)),
                                .sigma = 0.5 + static_cast<double>(random() % 30) / 10.0};
    SCOPED_TRACE(testing::Message() << rows << " x " << columns << ", " << options.kernel << ", " << options.sigma);
    const PolarImage out = apply_filter(image, options);
    ASSERT_EQ(out.rows(), rows);
    ASSERT_EQ(out.columns(), columns);
    EXPECT_EQ(out.wrap(), image.wrap());
    for (std::size_t n = 0; n < rows; ++n) {
      for (std::size_t i = 0; i < columns; ++i) {
        EXPECT_NEAR(out.row(n)[i], smoothed_pixel(image, static_cast<int>(n), static_cast<int>(i), options),
                    tolerance_of(options.filter));
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 30'000U);
}

TEST(ApplyFilter, TakesTheLargestKernelOnTheSmallestImages) {
  for (const Wrap wrap : {Wrap::kAround, Wrap::kNone}) {
    for (const Filter filter : kFilters) {
      SCOPED_TRACE(static_cast<int>(filter));
      PolarImage image({1}, 1, wrap);
      image.row(0)[0] = 200;
      const FilterOptions options{.filter = filter, .kernel = 99, .sigma = 30.0};
      EXPECT_THAT(apply_filter(image, options).row(0), Each(200));
      EXPECT_EQ(apply_filter(PolarImage({}, 0, wrap), options).rows(), 0U);
      EXPECT_EQ(apply_filter(PolarImage({0, 0}, 0, wrap), options).rows(), 2U);
    }
  }
}

TEST(ApplyFilter, LeavesTheImageAloneWithoutAFilter) {
  std::mt19937_64 random(7);
  const PolarImage image = random_image(random, 5, 9, Wrap::kAround);
  const PolarImage out = apply_filter(image, {.filter = Filter::kNone, .kernel = 5, .sigma = 1.0});
  for (std::size_t n = 0; n < image.rows(); ++n) EXPECT_TRUE(std::ranges::equal(out.row(n), image.row(n)));
}

TEST(ApplyFilter, DoesNotDarkenTheEndsOfShortBeamsNorTheirNeighbours) {
  PolarImage image({8, 3, 0, 8, 5, 5, 5, 5, 5, 5, 5}, 8, Wrap::kAround);
  for (std::size_t n = 0; n < image.rows(); ++n) std::ranges::fill(image.row(n).first(image.bins_in(n)), 100);
  for (const Filter filter : kFilters) {
    const PolarImage out = apply_filter(image, {.filter = filter, .kernel = 5, .sigma = 1.0});
    for (std::size_t n = 0; n < out.rows(); ++n) {
      SCOPED_TRACE(n);
      EXPECT_THAT(out.row(n).first(out.bins_in(n)), Each(100));
      EXPECT_THAT(out.row(n).subspan(out.bins_in(n)), Each(0)) << "bins that the beam does not have";
    }
  }
}

TEST(ApplyFilter, DependsOnNoBeamBeyondItsReach) {
  std::size_t changed = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const FilterOptions options{
        .filter = kFilters[seed % kFilters.size()], .kernel = static_cast<int>(1 + 2 * (random() % 4)), .sigma = 2.0};
    std::vector<std::size_t> bins(30);
    for (std::size_t& n : bins) n = random() % 12;
    bins[15] = 11;
    PolarImage image(bins, 11, Wrap::kNone);
    for (std::size_t n = 0; n < image.rows(); ++n) {
      for (std::uint8_t& pixel : image.row(n).first(bins[n])) pixel = static_cast<std::uint8_t>(random() % 256);
    }
    const PolarImage before = apply_filter(image, options);
    for (std::uint8_t& pixel : image.row(15)) pixel = static_cast<std::uint8_t>(255 - pixel);
    const PolarImage after = apply_filter(image, options);
    for (std::size_t n = 0; n < image.rows(); ++n) {
      const bool same = std::ranges::equal(before.row(n), after.row(n));
      changed += same ? 0U : 1U;
      const std::size_t distance = n < 15 ? 15 - n : n - 15;
      EXPECT_TRUE(same || distance <= reach_beams(options)) << n;
    }
  }
  EXPECT_GT(changed, 100U);
}

TEST(FilterOptions, NameEveryBrokenField) {
  EXPECT_TRUE(FilterOptions{}.validate());
  for (const int kernel : {-1, 0, 2, 100, 101}) EXPECT_FALSE((FilterOptions{.kernel = kernel}.validate())) << kernel;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double sigma : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE((FilterOptions{.sigma = sigma}.validate())) << sigma;
  }
  EXPECT_THAT((FilterOptions{.kernel = 4, .sigma = nan}.validate().error().message),
              AllOf(HasSubstr("kernel"), HasSubstr("sigma")));
}

}  // namespace
}  // namespace pingvox
