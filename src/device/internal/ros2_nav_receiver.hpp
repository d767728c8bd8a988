#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "device/internal/ros2_node.hpp"
#include "device/internal/ros2_publisher_watch.hpp"
#include "io/internal/ros2_topics.hpp"
#include "io/internal/tf_frames.hpp"
#include "pingvox/nav/nav_log.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Where navigation is read from.
struct Ros2NavAddress {
  std::string topic;               ///< "/odom"
  std::optional<TfFrames> frames;  ///< of a topic of tf, where they are named

  /// @param text  as in "/odom", "/tf" or "/tf:map:base_link"; nullopt: none of these: not the name of a
  ///              topic, twice the same frame, or frames of another topic than tf
  static std::optional<Ros2NavAddress> parse(const std::string& text);
  /// Whether it may be one of tf, by its name.
  bool is_tf() const { return topic.ends_with("tf"); }
};

/// Reads navigation from a topic of ROS 2, for tf also the static transforms, as soon as it has a publisher.
class Ros2NavReceiver {
 public:
  struct Status {
    bool is_connected = false;    ///< whether a usable message came in the last five seconds
    std::size_t connections = 0;  ///< how often it became so
    std::string problem;          ///< why it is not
    std::size_t messages = 0, damaged = 0;
    std::string refused;         ///< why none of the messages can be used; empty: they can
    std::string no_attitude;     ///< why messages of the last five seconds had no attitude; empty: they had
    std::size_t publishers = 0;  ///< that send at the same time; 0: at most one, or tf
  };

  /// @param address       as Ros2NavAddress
  /// @param since_1970_s  of the clock that `read` is told, at its 0
  /// @return kBadOption
  static Result<Ros2NavReceiver> make(const Ros2Node& node, const std::string& address, double since_1970_s);

  /// The samples that have arrived. @param now_s  on the beams' clock
  std::vector<NavSource> read(double now_s);

  const std::string& address() const { return address_; }
  /// -1: the topic has no publisher yet.
  int descriptor() const { return topic_ ? topic_->reader.descriptor() : -1; }
  const Status& status() const { return status_; }
  bool reads_tf() const { return from_.is_tf(); }

 private:
  struct Topic {
    Ros2Reader reader;
    ReadRos2Nav read;
  };
  Ros2NavReceiver(Ros2Node node, std::string address, Ros2NavAddress from, double since_1970_s)
      : node_(std::move(node)), address_(std::move(address)), from_(std::move(from)), since_1970_s_(since_1970_s) {}
  void open(double now_s);
  Result<void> open_as(const std::string& type);
  void refuse(const std::string& reason);
  void note_attitude(const NavSource& attitude, double now_s);
  std::optional<Result<std::vector<NavSource>>> next_of(const Topic& topic, double now_s);

  Ros2Node node_;
  std::string address_;
  Ros2NavAddress from_;
  std::optional<Topic> topic_;  ///< nullopt: no publisher yet
  std::optional<Topic> still_;  ///< static transforms, of tf
  double since_1970_s_;
  double last_s_ = 0.0;                       ///< when the last message came
  double look_s_ = 0.0;                       ///< when to look for the topic again
  std::optional<double> used_s_;              ///< when the last message came that was used
  std::size_t damaged_ = 0;                   ///< messages since then
  std::optional<double> without_attitude_s_;  ///< since when messages have none
  Ros2PublisherWatch publishers_;
  Status status_;
};

}  // namespace pingvox
