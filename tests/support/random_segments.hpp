#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>

#include "exact_segment.hpp"

namespace pingvox::test {

/// A point of ExactSegment in metres.
inline Eigen::Vector3d metres(const ExactSegment::Point& point, double resolution_m) {
  const auto axis = [&](std::size_t i) { return std::ldexp(static_cast<double>(point[i]), -ExactSegment::kShift); };
  return Eigen::Vector3d(axis(0), axis(1), axis(2)) * resolution_m;
}

/// Segments of many kinds, ends inside of +-reach cells (and a hair), all of them exact as doubles.
class RandomSegments {
 public:
  using Point = ExactSegment::Point;

  RandomSegments(std::uint64_t seed, std::int64_t reach) : random_(seed), reach_(reach) {
    while (reach >> (52 - ExactSegment::kShift) > 0) {
      reach /= 2;
      grain_ *= 2;
    }
  }

  std::pair<Point, Point> next() {
    Point from = any(), to = any();
    switch (random_() % 8) {
      case 0:  // ends on corners
        for (std::size_t i = 0; i < 3; ++i) from[i] = whole(from[i]), to[i] = whole(to[i]);
        break;
      case 1:  // on faces and edges
        for (std::size_t i = 0; i < 3; ++i) (random_() % 2 == 0 ? from : to)[i] = whole(from[i]);
        break;
      case 2:  // parallel to one or two axes
        to[random_() % 3] = from[0];
        to[random_() % 3] = from[1];
        for (std::size_t i = 0; i < 3; ++i) {
          if (random_() % 2 == 0) to[i] = from[i];
        }
        break;
      case 3: {  // an exact diagonal, through corners if the start is on one
        if (random_() % 2 == 0) {
          for (std::size_t i = 0; i < 3; ++i) from[i] = whole(from[i]);
        }
        const std::int64_t length = to[0] / 2;
        for (std::size_t i = 0; i < 3; ++i) from[i] /= 2;
        for (std::size_t i = 0; i < 3; ++i) to[i] = from[i] + (random_() % 2 == 0 ? length : -length);
        break;
      }
      case 4:  // a hair around a corner
        for (std::size_t i = 0; i < 3; ++i) {
          const std::int64_t corner = whole(from[i]);
          from[i] = corner + (static_cast<std::int64_t>(random_() % 5) - 2) * grain_;
          to[i] = corner + (static_cast<std::int64_t>(random_() % 5) - 2) * grain_;
        }
        break;
      case 5:  // whole slopes through the middle of cells
        for (std::size_t i = 0; i < 3; ++i)
          from[i] = whole(from[i]) + ExactSegment::kUnit / 2, to[i] = whole(to[i]) + ExactSegment::kUnit / 2;
        break;
      default:
        break;
    }
    return {from, to};
  }

 private:
  Point any() {
    const auto axis = [&] {
      const auto span = static_cast<std::uint64_t>(2 * reach_) << ExactSegment::kShift;
      return static_cast<std::int64_t>(random_() % span & ~(2 * static_cast<std::uint64_t>(grain_) - 1)) -
             (reach_ << ExactSegment::kShift);
    };
    return {axis(), axis(), axis()};
  }
  static std::int64_t whole(std::int64_t value) { return value & ~(ExactSegment::kUnit - 1); }
  std::mt19937_64 random_;
  std::int64_t reach_;
  std::int64_t grain_ = 1;
};

}  // namespace pingvox::test
