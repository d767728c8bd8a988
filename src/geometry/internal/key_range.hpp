#pragma once

#include <concepts>
#include <cstddef>
#include <iterator>
#include <ranges>
#include <utility>

#include "pingvox/geometry/key.hpp"

namespace pingvox {

/// Walks from cell to cell. `key` and `step` REQUIRE !done().
template <class S>
concept KeyStepper = std::copyable<S> && requires(S s, const S c) {
  { c.key() };
  { c.done() } -> std::same_as<bool>;
  s.step();
};

/// A ray as a range of keys: the start cell included, the end cell not, no cell twice, neighbours touch; from a cell to
/// itself it is empty. Iterators own their state, so a temporary range is safe.
template <KeyStepper Stepper>
class KeyRange : public std::ranges::view_interface<KeyRange<Stepper>> {
 public:
  class Iterator {
   public:
    using value_type = decltype(std::declval<const Stepper&>().key());
    using difference_type = std::ptrdiff_t;
    explicit Iterator(Stepper stepper) : stepper_(std::move(stepper)) {}
    value_type operator*() const { return stepper_.key(); }
    Iterator& operator++() {
      stepper_.step();
      return *this;
    }
    void operator++(int) { stepper_.step(); }
    friend bool operator==(const Iterator& it, std::default_sentinel_t) { return it.stepper_.done(); }

   private:
    Stepper stepper_;
  };

  explicit KeyRange(Stepper stepper) : stepper_(std::move(stepper)) {}
  Iterator begin() const { return Iterator(stepper_); }
  std::default_sentinel_t end() const { return {}; }

 private:
  Stepper stepper_;
};

}  // namespace pingvox
