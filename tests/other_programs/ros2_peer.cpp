// A node in place of ROS 2, by Fast DDS: it publishes the echoes of a sonar in a round tank, and odometry and tf of a
// vehicle in its middle, and keeps the last octomap that it receives.
//
// Usage: ros2_peer DOMAIN FILE SECONDS
// FILE gets the tree of the last message of /octomap_binary, when its publisher is gone or the time is over. Whoever
// publishes it has to be told as a node in the graph of Iron and newer.
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <fstream>
#include <iostream>
#include <memory>
#include <numbers>
#include <string>
#include <thread>

namespace {

using namespace eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

/// Messages as their bytes in CDR.
class Bytes : public TopicDataType {
 public:
  explicit Bytes(const std::string& type) {
    constexpr std::uint32_t kUsualSize = 1U << 16U;
    setName(type.c_str());
    m_typeSize = kUsualSize;
    m_isGetKeyDefined = false;
    auto_fill_type_information(false);
    auto_fill_type_object(false);
  }
  bool serialize(void* data, rtps::SerializedPayload_t* payload) override {
    const auto& bytes = *static_cast<const std::string*>(data);
    payload->encapsulation = CDR_LE;
    payload->length = static_cast<std::uint32_t>(bytes.size());
    std::memcpy(payload->data, bytes.data(), bytes.size());
    return true;
  }
  bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
    static_cast<std::string*>(data)->assign(reinterpret_cast<const char*>(payload->data), payload->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [size = static_cast<std::uint32_t>(static_cast<const std::string*>(data)->size())] { return size; };
  }
  void* createData() override { return new std::string; }
  void deleteData(void* data) override { delete static_cast<std::string*>(data); }
  bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }
};

/// Puts a message together: numbers at multiples of their size, counted from behind the first four bytes.
class Cdr {
 public:
  template <class T>
  Cdr& number(T value) {
    while ((bytes_.size() - 4) % sizeof(T) != 0) bytes_.push_back('\0');
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
    return *this;
  }
  Cdr& text(const std::string& value) {
    number(static_cast<std::uint32_t>(value.size() + 1));
    bytes_.append(value.c_str(), value.size() + 1);
    return *this;
  }
  Cdr& header(const std::string& frame) {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
    number(static_cast<std::int32_t>(ns / 1'000'000'000)).number(static_cast<std::uint32_t>(ns % 1'000'000'000));
    return text(frame);
  }
  std::string& bytes() { return bytes_; }

 private:
  std::string bytes_ = std::string("\0\1\0\0", 4);
};

/// Of a wall 5 m around the sonar.
std::string echo(double angle_rad) {
  constexpr std::uint32_t kSamples = 200;
  Cdr message;
  message.header("sonar").number(static_cast<float>(angle_rad)).number(std::uint8_t{1});
  message.number(static_cast<std::uint16_t>(kSamples)).number(std::uint16_t{750}).number(std::uint16_t{1500});
  message.number(std::uint8_t{10}).number(kSamples);
  for (std::uint32_t i = 0; i < kSamples; ++i) message.number(static_cast<std::uint8_t>(i / 5 == 20 ? 220 : 7));
  return message.bytes();
}

std::string odometry() {
  Cdr message;
  message.header("odom").text("base_link");
  for (const double value : {3.0, 2.0, -1.0, 0.0, 0.0, 0.0, 1.0}) message.number(value);
  for (int i = 0; i < 36 + 6 + 36; ++i) message.number(0.0);
  return message.bytes();
}

/// One transform, without rotation.
std::string transform(const std::string& parent, const std::string& child, const std::array<double, 3>& place) {
  Cdr message;
  message.number(std::uint32_t{1}).header(parent).text(child);
  for (const double value : place) message.number(value);
  for (const double value : {0.0, 0.0, 0.0, 1.0}) message.number(value);
  return message.bytes();
}

/// What is behind the header of the file: the last field of the message.
std::string tree_of(const std::string& message) {
  // Stamp, frame, whether it is binary, id and resolution; each text is padded as its next field asks for.
  const auto word = [&](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, message.substr(at, sizeof value).data(), sizeof value);
    return static_cast<std::size_t>(value);
  };
  const auto aligned = [](std::size_t at, std::size_t to) { return 4 + (at - 4 + to - 1) / to * to; };
  std::size_t at = 12;
  at += 4 + word(at) + 1;
  at = aligned(at, 4);
  at += 4 + word(at);
  at = aligned(at, 8) + 8;
  return message.substr(at + 4, word(at));
}

/// As the graph of nodes has it.
std::string gid_of(const rtps::GUID_t& guid) {
  std::string gid(guid.guidPrefix.value, guid.guidPrefix.value + rtps::GuidPrefix_t::size);
  return gid.append(guid.entityId.value, guid.entityId.value + rtps::EntityId_t::size);
}

class Node {
 public:
  explicit Node(int domain) {
    DomainParticipantQos qos;
    // Cyclone has no shared memory, and a test no network.
    const auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList.emplace_back("127.0.0.1");
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(udp);
    rtps::Locator_t peer;
    peer.kind = LOCATOR_KIND_UDPv4;
    rtps::IPLocator::setIPv4(peer, "127.0.0.1");
    qos.wire_protocol().builtin.initialPeersList.push_back(peer);
    participant_ = DomainParticipantFactory::get_instance()->create_participant(static_cast<DomainId_t>(domain), qos);
    publisher_ = participant_->create_publisher(PUBLISHER_QOS_DEFAULT);
    subscriber_ = participant_->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
  }
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;
  ~Node() {
    participant_->delete_contained_entities();
    DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }

  DataWriter* writer(const std::string& name, const std::string& type,
                     DurabilityQosPolicyKind durability = VOLATILE_DURABILITY_QOS) {
    DataWriterQos qos = DATAWRITER_QOS_DEFAULT;
    qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
    qos.durability().kind = durability;
    qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    return publisher_->create_datawriter(topic(name, type), qos);
  }
  /// Of what is said to who comes later.
  DataReader* reader(const std::string& name, const std::string& type) {
    DataReaderQos qos = DATAREADER_QOS_DEFAULT;
    qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
    qos.durability().kind = TRANSIENT_LOCAL_DURABILITY_QOS;
    qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    return subscriber_->create_datareader(topic(name, type), qos);
  }

 private:
  Topic* topic(const std::string& name, const std::string& type) {
    TypeSupport(new Bytes(type)).register_type(participant_);
    return participant_->create_topic(name, type, TOPIC_QOS_DEFAULT);
  }

  DomainParticipant* participant_ = nullptr;
  Publisher* publisher_ = nullptr;
  Subscriber* subscriber_ = nullptr;
};

}  // namespace

int main(int count, char** args) {
  if (count != 4) {
    std::cerr << "Usage: ros2_peer DOMAIN FILE SECONDS\n";
    return 2;
  }
  Node node(std::stoi(args[1]));
  DataWriter* const echoes = node.writer("rt/scan_echo", "ping360_sonar_msgs::msg::dds_::SonarEcho_");
  DataWriter* const poses = node.writer("rt/odom", "nav_msgs::msg::dds_::Odometry_");
  const std::string tf_type = "tf2_msgs::msg::dds_::TFMessage_";
  DataWriter* const moving = node.writer("rt/tf", tf_type);
  DataWriter* const still = node.writer("rt/tf_static", tf_type, TRANSIENT_LOCAL_DURABILITY_QOS);
  std::string mount = transform("base_footprint", "base_link", {0.0, 0.0, -1.0});
  still->write(&mount);
  DataReader* const maps = node.reader("rt/octomap_binary", "octomap_msgs::msg::dds_::Octomap_");
  DataReader* const graph = node.reader("ros_discovery_info", "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_");
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(std::stoi(args[3]));
  std::string last, nodes;
  rtps::GUID_t map_writer;
  int maps_count = 0;
  bool has_matched = false;
  constexpr int kStepsOfTurn = 200;
  for (int i = 0; std::chrono::steady_clock::now() < end; ++i) {
    std::string pose = odometry();
    poses->write(&pose);
    std::string place = transform("odom", "base_footprint", {3.0, 2.0, 0.0});
    moving->write(&place);
    std::string sent = echo(2.0 * std::numbers::pi * (i % kStepsOfTurn) / kStepsOfTurn);
    echoes->write(&sent);
    // What no reader may trip over.
    std::string broken = sent.substr(0, 30);
    if (i % 50 == 49) echoes->write(&broken);
    std::string huge = sent.substr(0, sent.size() - 204) + "\xff\xff\xff\x7f";
    if (i % 50 == 24) echoes->write(&huge);
    SampleInfo info;
    std::string message;
    while (maps->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      last = message;
      map_writer = rtps::iHandle2GUID(info.publication_handle);
      ++maps_count;
    }
    while (graph->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
      if (info.valid_data) nodes = message;
    }
    // It ends with the program.
    SubscriptionMatchedStatus matched;
    maps->get_subscription_matched_status(matched);
    has_matched = has_matched || matched.current_count > 0;
    if (has_matched && matched.current_count == 0) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  std::cout << maps_count << " maps\n";
  if (last.empty()) return 1;
  const rtps::GUID_t participant(map_writer.guidPrefix, rtps::c_EntityId_RTPSParticipant);
  const std::string name("\x08\0\0\0pingvox\0", 12);
  const bool is_told = nodes.compare(4, 16, gid_of(participant)) == 0 && nodes.find(name) != std::string::npos &&
                       nodes.find(gid_of(map_writer)) != std::string::npos;
  std::cout << (is_told ? "the node pingvox has the writer of the maps\n" : "no node has the writer of the maps\n");
  if (!is_told) return 1;
  std::ofstream(args[2], std::ios::binary) << tree_of(last);
  return 0;
}
