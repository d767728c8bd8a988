#pragma once

#include <cstddef>
#include <optional>

#include "io/bags/bag.hpp"
#include "io/nav/mavlink_log.hpp"
#include "io/nav/nav_readers.hpp"

// MAVLink messages in bags, in JSON, as the recorder of BlueOS writes them (docs/formats.md).
namespace pingvox {

/// Whether messages of a topic are those of MAVLink.
enum class MavlinkTopic {
  kNone,
  kOfMessage,  ///< one kind of message of one sender
  kAll         ///< all messages, each of which has a topic of its own besides
};

MavlinkTopic mavlink_topic(const BagTopic& topic);

/// Whether such a topic has messages that are converted to navigation.
bool is_navigation(const BagTopic& topic, MavlinkTopic kind);

struct MavlinkMessages {
  MavlinkLog log;
  std::size_t count = 0;
};

/// The navigation in the MAVLink messages of a bag.
class BagMavlink {
 public:
  /// Adds a message. Those of the topic with all of them count only in a bag without others.
  /// @return false where its text is no such message
  bool add(const BagMessage& message, MavlinkTopic topic);

  /// As MavlinkLog::finish, where there are messages; counts them as records, too.
  void finish(NavReading& reading);

 private:
  std::optional<MavlinkMessages> of_messages_, all_;  ///< of kOfMessage, and of kAll while there are no others
};

}  // namespace pingvox
