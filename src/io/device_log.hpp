#pragma once

#include <optional>
#include <string_view>
#include <utility>

#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// Tells the beams of a log's first head from those of others on the same line: together they are not one picture.
class FirstHead {
 public:
  /// @param head  the number of a head that sent a beam
  bool is(unsigned head) {
    first_ = first_.value_or(head);
    return *first_ == head;
  }

 private:
  std::optional<unsigned> first_;
};
inline constexpr std::string_view kOtherHead = "beam of another head";  ///< kind of damage

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
