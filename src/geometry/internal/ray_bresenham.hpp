#pragma once

#include <algorithm>
#include <cstdint>

#include "geometry/internal/key_range.hpp"
#include "pingvox/geometry/key.hpp"

namespace pingvox {

/// Bresenham's line in three dimensions (paper, section 6.2): one step along the main axis at a time, the other two
/// follow when their error asks for it, so neighbours may touch at an edge or corner only.
template <KeyWord W>
class BresenhamStepper {
 public:
  BresenhamStepper(const BasicKey<W>& start, const BasicKey<W>& end)
      : key_(start), x_(start.x, end.x), y_(start.y, end.y), z_(start.z, end.z) {
    main_ = std::max({x_.distance, y_.distance, z_.distance});
    left_ = main_;
    // Half a cell, rounded so that a line exactly between two cells stays in the nearer one.
    const W half = main_ > 0 ? static_cast<W>((main_ - 1) / 2) : W{0};
    for (Axis* axis : {&x_, &y_, &z_}) axis->error = half;
  }
  BasicKey<W> key() const { return key_; }
  bool done() const { return left_ == 0; }
  void step() {
    x_.step(key_.x, main_);
    y_.step(key_.y, main_);
    z_.step(key_.z, main_);
    --left_;
  }

 private:
  struct Axis {
    Axis(W from, W to) : distance(static_cast<W>(from < to ? to - from : from - to)), is_ahead(from < to) {}
    // Adds distance / main of a cell. `error` stays below main, and compares before it adds: no more bits than a key's.
    void step(W& word, W main) {
      if (error < static_cast<W>(main - distance)) {
        error = static_cast<W>(error + distance);
        return;
      }
      error = static_cast<W>(error - static_cast<W>(main - distance));
      word = static_cast<W>(is_ahead ? word + 1 : word - 1);
    }
    W distance;
    W error = 0;  ///< in cells / main
    bool is_ahead;
  };

  BasicKey<W> key_;
  Axis x_, y_, z_;
  W main_ = 0, left_ = 0;
};

/// The cells of the line between two keys, the start cell included, the end cell not.
template <KeyWord W>
KeyRange<BresenhamStepper<W>> bresenham(const BasicKey<W>& start, const BasicKey<W>& end) {
  return KeyRange(BresenhamStepper<W>(start, end));
}

}  // namespace pingvox
