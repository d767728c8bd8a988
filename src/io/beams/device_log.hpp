#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>

#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// Tells the beams of a log's first head from those of others on the same line: together they are not one picture. A
/// head that sent a single beam, before kEnough of another one, is a damaged number.
class FirstHead {
 public:
  /// @param head  the number of a head that sent a beam
  bool is(unsigned head) {
    first_ = first_.value_or(head);
    if (*first_ == head) {
      ++beams_;
      return true;
    }
    other_beams_ = other_ == head ? other_beams_ + 1 : 1;
    other_ = head;
    if (beams_ != 1 || other_beams_ != kEnough) return false;
    first_ = head;
    beams_ = kEnough;
    return true;
  }

 private:
  static constexpr std::size_t kEnough = 8;
  std::optional<unsigned> first_, other_;
  std::size_t beams_ = 0;        ///< of the first head
  std::size_t other_beams_ = 0;  ///< of the other one in succession
};

// Kinds of damage.
inline constexpr std::string_view kOtherHead = "beam of another head", kProfilingHead = "line of a profiling head",
                                  kImpossibleValues = "impossible values";

/// Kind of a beam that cannot be used.
inline std::string_view damage_kind_of(std::string_view reason) {
  return reason == kProfilingHead ? kProfilingHead : kImpossibleValues;
}

/// A log that names its head in its beams. It reads one beam ahead, so that device() is known before the first next().
class DeviceLog : public BeamSource {
 public:
  Result<std::optional<Beam>> next() final {
    if (ahead_) return *std::exchange(ahead_, std::nullopt);
    return read();
  }
  const DeviceProfile* device() const final { return device_; }

 protected:
  /// The next beam of the log, as next().
  virtual Result<std::optional<Beam>> read() = 0;
  /// Called by the constructor with the first beam, which next() then returns.
  void set_first(Result<std::optional<Beam>> beam) { ahead_ = std::move(beam); }

  bool is_of_first_head(unsigned head) { return first_head_.is(head); }

  const DeviceProfile* device_ = nullptr;  ///< set by read()

 private:
  FirstHead first_head_;
  std::optional<Result<std::optional<Beam>>> ahead_;
};

}  // namespace pingvox
