#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "device/internal/ros2_node.hpp"
#include "io/internal/ros2_topics.hpp"
#include "io/internal/tf_frames.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// The type of a topic, once somebody publishes it.
/// @return kIo when nobody does for ten seconds
Result<std::string> wait_for_type(const Ros2Node& node, const std::string& topic);

/// Where navigation is read.
struct Ros2NavAddress {
  std::string topic;               ///< "/odom"
  std::optional<TfFrames> frames;  ///< of a topic of tf, where they are named

  /// @param text  as in "/odom", "/tf" or "/tf:map:base_link"; nullopt: it is none of these
  static std::optional<Ros2NavAddress> parse(const std::string& text);
};

/// Reads navigation from a topic of ROS 2, of tf also from that of its static transforms.
class Ros2NavReceiver {
 public:
  struct Status {
    bool is_connected = false;    ///< whether a message that tells something came in the last five seconds
    std::size_t connections = 0;  ///< how often it became so
    std::string problem;          ///< why it is not
    std::size_t messages = 0, damaged = 0;
  };

  /// @param address       as Ros2NavAddress
  /// @param since_1970_s  of the clock that `read` is told, at its 0
  /// @return kBadOption for frames of another topic than tf; else as wait_for_type and read_ros2_nav
  static Result<Ros2NavReceiver> make(const Ros2Node& node, const std::string& address, double since_1970_s);

  /// The samples that have arrived. @param now_s  on the beams' clock
  std::vector<NavSource> read(double now_s);

  const std::string& address() const { return address_; }
  int descriptor() const { return topic_.reader.descriptor(); }
  const Status& status() const { return status_; }
  bool reads_tf() const { return still_.has_value(); }

 private:
  struct Topic {
    Ros2Reader reader;
    ReadRos2Nav read;
  };
  Ros2NavReceiver(std::string address, Topic topic, double since_1970_s)
      : address_(std::move(address)), topic_(std::move(topic)), since_1970_s_(since_1970_s) {}
  std::optional<Result<std::vector<NavSource>>> next_of(const Topic& topic);

  std::string address_;
  Topic topic_;
  std::optional<Topic> still_;  ///< static transforms, of tf
  double since_1970_s_;
  double last_s_ = 0.0;  ///< when the last message came
  Status status_;
};

}  // namespace pingvox
