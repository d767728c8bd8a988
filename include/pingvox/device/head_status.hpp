#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "pingvox/result.hpp"

namespace pingvox {

/// State of the connection to a sonar head, and of its recording.
struct HeadStatus {
  bool is_connected = false;
  std::size_t connections = 0;  ///< how often it was connected
  std::string problem;          ///< why it is not connected, or not any more
  std::size_t unanswered = 0;   ///< requests without an answer
  std::size_t damaged = 0;      ///< damaged frames, and runs of bytes between frames
  /// Beams that do not fit the request that they answer, as of another range: they are recorded and left out.
  std::size_t unexpected = 0;
  std::string first_unexpected;          ///< why the first one does not fit
  std::optional<Error> recording_error;  ///< what is wrong with the recording; the beams go on
  // Of a topic of ROS 2.
  std::string refused;         ///< why none of the messages can be used; empty: they can
  std::size_t publishers = 0;  ///< that send at the same time; 0: at most one
};

}  // namespace pingvox
