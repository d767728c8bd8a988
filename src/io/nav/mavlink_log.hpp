#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/internal/mavlink_nav.hpp"
#include "io/nav/nav_readers.hpp"
#include "io/nav/nav_sources.hpp"
#include "pingvox/nav/device_clock.hpp"

namespace pingvox {

/// The navigation in a log of MAVLink messages, whose times are found once all are known.
class MavlinkLog {
 public:
  /// @param received_s  by the clock of who recorded it, since 1970
  void add(const MavlinkFrame& frame, double received_s);

  /// Sets sources, notes, settings and runs. Times are estimated from the whole log. Of several vehicles the one with
  /// the most messages is read.
  void finish(NavReading& reading);

 private:
  static constexpr std::uint8_t kAutopilot = 1;  // component

  /// A message with a time of its sender.
  struct Timed {
    std::size_t message;
    double made_s;
  };
  /// Where a message is in `timed_`.
  struct Made {
    MavlinkNav::Sender sender;
    std::size_t place;
  };
  /// The message that a sample is of.
  struct Origin {
    std::size_t message;
    std::optional<Made> made;
  };
  /// Of a sender's messages in `timed_`.
  using Places = std::vector<std::size_t>;

  std::optional<Made> timed_of(const MavlinkNav::Report& report, std::size_t message);
  void leave_out_other_systems(NavReading& reading);
  Places places_of_one_device(const MavlinkNav::Sender& sender, const std::vector<Timed>& timed, NavReading& reading);
  std::vector<ReceivedMessage> messages_of_one_device(const std::map<MavlinkNav::Sender, Places>& own) const;
  void find_times(const MavlinkNav::Sender& sender, const Places& places, const ReceiverTimes& received,
                  NavReading& reading);
  void set_times(NavSource& source, const ReceiverTimes& received) const;

  MavlinkNav nav_;
  NavSources sources_;
  std::map<std::uint8_t, std::size_t> frames_of_vehicles_;  ///< with navigation, by system
  std::map<std::string, MavlinkNav::Sender> senders_;       ///< of each source
  std::vector<MavlinkNav::Sender> shared_;                  ///< whose address several devices have
  std::vector<ReceivedMessage> messages_;                   ///< of all records, without times of devices
  std::map<MavlinkNav::Sender, std::vector<Timed>> timed_;
  std::map<MavlinkNav::Sender, std::vector<double>> made_s_;                    ///< when those of `timed_` were made
  std::map<std::pair<std::string, NavQuantity>, std::vector<Origin>> origins_;  ///< of each sample
};

}  // namespace pingvox
