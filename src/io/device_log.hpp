#pragma once

#include <optional>
#include <utility>

#include "pingvox/sonar/beam.hpp"

namespace pingvox {

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

  const DeviceProfile* device_ = nullptr;  ///< set by read()

 private:
  std::optional<Result<std::optional<Beam>>> ahead_;
};

}  // namespace pingvox
