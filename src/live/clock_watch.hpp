#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

namespace pingvox {

/// Compares the clocks that stamp beams and navigation by the lag of each message: arrival less stamp. Delays only add,
/// so the smallest lag of some seconds is the offset of the clocks and the shortest delay.
class ClockWatch {
 public:
  /// @param devices  of the navigation
  explicit ClockWatch(std::size_t devices) : devices_(devices) {}

  /// Notes the lag of a beam; negative: it came before its stamp.
  void add_beam(double lag_s) { beams_.add(lag_s); }
  /// The same for a sample of a device, by its number.
  void add_sample(std::size_t device, double lag_s) { devices_[device].lag.add(lag_s); }

  struct Difference {
    std::size_t device = 0;
    double ahead_s = 0.0;  ///< of its stamps before those of the beams; negative: behind
  };
  /// The devices whose stamps differ from those of the beams since the last call, each once until it agrees.
  std::vector<Difference> update(double now_s);
  /// Forgets all lags so far.
  void restart(double now_s);

 private:
  struct Lag {
    double smallest_s = std::numeric_limits<double>::infinity();
    std::size_t count = 0;

    void add(double lag_s);
  };
  struct Device {
    Lag lag;
    std::optional<double> ahead_s;  ///< in the window before
    bool is_reported = false;
  };
  std::optional<double> judge(Device& device) const;

  Lag beams_;
  std::vector<Device> devices_;
  std::optional<double> from_s_;  ///< of the window
};

}  // namespace pingvox
