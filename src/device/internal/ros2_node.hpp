#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pingvox/device/ros2_network.hpp"
#include "pingvox/result.hpp"

// Topics of ROS 2 over DDS, by Cyclone DDS and without ROS. A message is its bytes in CDR, as bags have them.
namespace pingvox {

/// The quality of service of a writer.
enum class Ros2Delivery {
  kStream,     ///< reliable, volatile, the last messages: odometry, tf
  kKeepsLast,  ///< reliable, transient local, the last message: maps, tf_static
};

struct Ros2Topic {
  std::string name;            ///< as in "/octomap_binary"
  std::string type;            ///< as in "octomap_msgs/msg/Octomap"
  std::string type_hash = {};  ///< as in "RIHS01_9891..."; empty: unknown, which is harmless
};

class Ros2Graph;
class Ros2Participant;
class Ros2Subscription;

/// Writes the messages of one topic, also in another thread than the node's.
class Ros2Writer {
 public:
  /// Waits for slow readers: with kKeepsLast up to a second, else 20 ms.
  /// @return kIo when it is not sent
  Result<void> write(const std::string& message) const;

 private:
  friend class Ros2Node;
  Ros2Writer(std::shared_ptr<const Ros2Participant> participant, int writer)
      : participant_(std::move(participant)), writer_(writer) {}

  std::shared_ptr<const Ros2Participant> participant_;
  [[maybe_unused]] int writer_;  // without Cyclone DDS
};

/// A message, and who sent it.
struct Ros2Sample {
  std::string bytes;
  std::uint64_t publisher = 0;  ///< a number that no other publisher has
};

/// Reads the messages of one topic, best effort, which matches every writer. Also in another thread than the node's.
class Ros2Reader {
 public:
  /// For poll(): readable when `take` may have something.
  int descriptor() const;
  /// The next message, without padding to four bytes where the header states it; nullopt: none came in this time. Of
  /// messages that are not taken the last hundred are kept.
  std::optional<Ros2Sample> take_sample(double wait_s) const;
  /// The same without its sender.
  std::optional<std::string> take(double wait_s) const;

 private:
  friend class Ros2Node;
  explicit Ros2Reader(std::shared_ptr<const Ros2Subscription> subscription) : subscription_(std::move(subscription)) {}

  std::shared_ptr<const Ros2Subscription> subscription_;
};

/// A participant of a domain, which lives as long as its writers and readers. Where the distribution of the others is
/// known, it announces itself as the node "/pingvox" with its topics.
class Ros2Node {
 public:
  /// @return kUnsupported where pingvox was built without Cyclone DDS, kBadOption for a network that does not validate,
  ///         kIo where it cannot be opened: no such interface, or all participant indices are in use
  static Result<Ros2Node> open(const Ros2Network& network);

  /// @return kIo
  Result<Ros2Writer> write(const Ros2Topic& topic, Ros2Delivery delivery) const;
  /// @return kIo
  Result<Ros2Reader> read(const Ros2Topic& topic, Ros2Delivery delivery) const;

  /// The type of a topic, as in "nav_msgs/msg/Odometry", by those who write it; nullopt: nobody (yet).
  std::optional<std::string> type_of(const std::string& topic) const;
  /// What other participants write: "/odom", and DDS topics that are not of ROS.
  std::vector<std::string> topics_of_others() const;
  const Ros2Network& network() const { return network_; }

 private:
  Ros2Node(Ros2Network network, std::shared_ptr<const Ros2Participant> participant)
      : network_(std::move(network)), participant_(std::move(participant)) {}

  Ros2Network network_;
  std::shared_ptr<const Ros2Participant> participant_;
  std::shared_ptr<Ros2Graph> graph_;  ///< nullptr: not announced
};

/// Whether a text is the full name of a topic: words of letters, digits and underscores, a slash before each, none of
/// which begins with a digit.
bool is_ros2_topic(std::string_view text);
/// Why there is nothing to read: a topic without a publisher, and what is seen instead.
std::string why_not_published(const Ros2Node& node);

/// A name of ROS as DDS has it: topic "/odom" as "rt/odom". One without a slash is that of DDS.
std::string dds_topic(const std::string& topic);
/// Type "nav_msgs/msg/Odometry" as "nav_msgs::msg::dds_::Odometry_".
std::string dds_type(const std::string& type);
/// The inverse; nullopt: not a type of ROS.
std::optional<std::string> ros_type(const std::string& dds_type);

}  // namespace pingvox
