#include "device/internal/ros2_node.hpp"

#ifdef PINGVOX_HAS_ROS2
#include <dds/dds.h>
#include <fmt/core.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <set>

#include "device/ros2_payload.hpp"
#include "io/internal/descriptor.hpp"
#include "io/internal/ros2_messages.hpp"
#endif

namespace pingvox {

#ifdef PINGVOX_HAS_ROS2

/// Its entities of Cyclone DDS, which are numbers.
class Ros2Participant {
 public:
  Ros2Participant(dds_entity_t domain, dds_entity_t participant, dds_entity_t publications)
      : domain_(domain), participant_(participant), publications_(publications) {}
  Ros2Participant(const Ros2Participant&) = delete;
  Ros2Participant& operator=(const Ros2Participant&) = delete;
  ~Ros2Participant() {
    dds_delete(participant_);
    if (domain_ > 0) dds_delete(domain_);
  }

  dds_entity_t entity() const { return participant_; }
  dds_entity_t publications() const { return publications_; }

 private:
  dds_entity_t domain_;  ///< 0: made by Cyclone, which keeps it as long as it has participants
  dds_entity_t participant_, publications_;
};

/// A reader of Cyclone DDS, and an event that wakes waiting threads.
class Ros2Subscription {
 public:
  explicit Ros2Subscription(std::shared_ptr<const Ros2Participant> participant)
      : participant_(std::move(participant)), event_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}
  Ros2Subscription(const Ros2Subscription&) = delete;
  Ros2Subscription& operator=(const Ros2Subscription&) = delete;
  ~Ros2Subscription() {
    if (reader_ > 0) dds_delete(reader_);
  }

  /// @return an error of Cyclone DDS, or 0
  dds_return_t open(dds_entity_t topic, const dds_qos_t* qos) {
    if (!event_.valid()) return DDS_RETCODE_OUT_OF_RESOURCES;
    dds_listener_t* const listener = dds_create_listener(this);
    dds_lset_data_available(listener, wake);
    reader_ = dds_create_reader(participant_->entity(), topic, qos, listener);
    dds_delete_listener(listener);
    return std::min(reader_, 0);
  }

  dds_entity_t reader() const { return reader_; }
  int descriptor() const { return event_.get(); }
  void sleep_on() const {
    std::uint64_t count = 0;
    static_cast<void>(::read(event_.get(), &count, sizeof count));
  }

 private:
  static void wake(dds_entity_t, void* subscription) {
    constexpr std::uint64_t kOnce = 1;
    const int event = static_cast<const Ros2Subscription*>(subscription)->event_.get();
    static_cast<void>(::write(event, &kOnce, sizeof kOnce));
  }

  std::shared_ptr<const Ros2Participant> participant_;
  Descriptor event_;
  dds_entity_t reader_ = 0;
};

/// Announces the writers and readers of this node in the graph of ROS.
class Ros2Graph {
 public:
  Ros2Graph(Ros2Writer topic, Ros2GidSize size, dds_entity_t participant) : topic_(std::move(topic)), size_(size) {
    info_.node = "pingvox";
    info_.participant = guid_of(participant);
  }
  /// @return kIo
  Result<void> add_writer(dds_entity_t writer) {
    info_.writers.push_back(guid_of(writer));
    return announce();
  }
  /// @return kIo
  Result<void> add_reader(dds_entity_t reader) {
    info_.readers.push_back(guid_of(reader));
    return announce();
  }
  /// @return kIo
  Result<void> announce() const { return topic_.write(ros2_participant_info(info_, size_)); }

 private:
  static DdsGuid guid_of(dds_entity_t entity) {
    dds_guid_t guid{};
    dds_get_guid(entity, &guid);
    return std::to_array(guid.v);
  }

  Ros2Writer topic_;
  Ros2GidSize size_;
  Ros2ParticipantInfo info_;
};

namespace {

using Qos = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;

/// Keeps Cyclone from printing.
void keep_quiet(void*, const dds_log_data_t*) {}

tl::unexpected<Error> dds_error(const std::string& what, dds_return_t code) {
  return fail(Error::Code::kIo, fmt::format("ros2: {}: {}", what, dds_strretcode(code)));
}

/// Of this host alone, without multicast, which a loopback may not have.
constexpr std::string_view kLoopback =
    "<General><Interfaces><NetworkInterface name=\"lo\"/></Interfaces><AllowMulticast>false</AllowMulticast></General>"
    "<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>"
    "<Peers><Peer Address=\"127.0.0.1\"/></Peers></Discovery>";

std::string config_of(const Ros2Network& network) {
  if (network.interface == "lo") return fmt::format("<CycloneDDS><Domain>{}</Domain></CycloneDDS>", kLoopback);
  return fmt::format(
      "<CycloneDDS><Domain><General><Interfaces><NetworkInterface name=\"{}\"/></Interfaces></General>"
      "</Domain></CycloneDDS>",
      network.interface);
}

/// Of writers and readers, and with `kKeepsLast` of the topic.
Qos qos_of(Ros2Delivery delivery, std::int32_t depth, const std::string& type_hash) {
  // Of poses the next one comes soon.
  constexpr dds_duration_t kLongestMap = DDS_SECS(1), kLongestPose = DDS_MSECS(20);
  Qos qos(dds_create_qos(), &dds_delete_qos);
  const bool keeps_last = delivery == Ros2Delivery::kKeepsLast;
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, depth);
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, keeps_last ? kLongestMap : kLongestPose);
  dds_qset_durability(qos.get(), keeps_last ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  if (keeps_last) {
    dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, depth, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED);
  }
  dds_qset_writer_data_lifecycle(qos.get(), false);
  if (!type_hash.empty()) {
    const std::string text = fmt::format("typehash={};", type_hash);
    dds_qset_userdata(qos.get(), text.data(), text.size());
  }
  return qos;
}

Result<dds_entity_t> topic_entity(const Ros2Participant& participant, const Ros2Topic& topic) {
  ddsi_sertype* type = make_payload_type(dds_type(topic.type));
  if (type == nullptr) return fail(Error::Code::kNoMemory, "ros2: out of memory");
  ddsi_sertype* const made = type;
  const dds_entity_t entity =
      dds_create_topic_sertype(participant.entity(), dds_topic(topic.name).c_str(), &type, nullptr, nullptr, nullptr);
  if (entity < 0) {
    free_payload_type(made);
    return dds_error(topic.name, entity);
  }
  return entity;
}

/// Calls `use` with each writer of the domain that is known now.
template <class Use>
void for_each_publication(const Ros2Participant& participant, Use use) {
  constexpr std::size_t kMaxWriters = 4096;  // a node of ROS has some ten
  std::vector<void*> found(kMaxWriters, nullptr);
  std::vector<dds_sample_info_t> infos(kMaxWriters);
  const dds_return_t count =
      dds_read_mask(participant.publications(), found.data(), infos.data(), kMaxWriters, kMaxWriters,
                    DDS_ALIVE_INSTANCE_STATE | DDS_ANY_SAMPLE_STATE | DDS_ANY_VIEW_STATE);
  for (dds_return_t i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (infos[at].valid_data) use(*static_cast<const dds_builtintopic_endpoint_t*>(found[at]));
  }
  if (count > 0) dds_return_loan(participant.publications(), found.data(), count);
}

/// Without its padding, by the low bits of the header.
void strip(std::string& message) {
  constexpr std::size_t kHeaderBytes = 4;
  constexpr unsigned kFill = 3;
  if (message.size() < kHeaderBytes) return;
  const std::size_t fill = static_cast<unsigned char>(message[kHeaderBytes - 1]) & kFill;
  if (message.size() >= kHeaderBytes + fill) message.erase(message.size() - fill);
}

}  // namespace

Result<void> check_ros2_is_built() {
  return {};
}

Result<Ros2Node> Ros2Node::open(const Ros2Network& network) {
  if (const auto valid = network.validate(); !valid) return tl::unexpected(valid.error());
  const auto number = static_cast<dds_domainid_t>(network.domain);
  dds_set_log_sink(keep_quiet, nullptr);
  dds_set_trace_sink(keep_quiet, nullptr);
  dds_entity_t domain = 0;
  if (!network.interface.empty()) {
    domain = dds_create_domain(number, config_of(network).c_str());
    // Of another node of this process, whose interface it has.
    if (domain == DDS_RETCODE_PRECONDITION_NOT_MET) domain = 0;
    if (domain < 0) {
      return fail(Error::Code::kIo, fmt::format("ros2: the network interface {} cannot be used: does it exist, and is "
                                                "it up?",
                                                network.interface));
    }
  }
  // As nodes of ROS have it: others do not list the participant.
  constexpr std::string_view kEnclave = "enclave=/;";
  Qos qos(dds_create_qos(), &dds_delete_qos);
  dds_qset_userdata(qos.get(), kEnclave.data(), kEnclave.size());
  const dds_entity_t participant = dds_create_participant(number, qos.get(), nullptr);
  if (participant < 0) {
    if (domain > 0) dds_delete(domain);
    const char* const config = std::getenv("CYCLONEDDS_URI");  // NOLINT(concurrency-mt-unsafe): nobody sets variables
    // Not read where the interface is named.
    const bool may_be_config = network.interface.empty() && config != nullptr && *config != '\0';
    return dds_error(
        fmt::format("domain {}{}", network.domain,
                    may_be_config ? fmt::format(" with the configuration of CYCLONEDDS_URI, {}", config) : ""),
        participant);
  }
  const dds_entity_t publications = dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr);
  Ros2Node node(network, std::make_shared<const Ros2Participant>(domain, participant, publications));
  if (!network.distribution) return node;
  Result<Ros2Writer> graph =
      node.write({"ros_discovery_info", "rmw_dds_common/msg/ParticipantEntitiesInfo"}, Ros2Delivery::kKeepsLast);
  if (!graph) return tl::unexpected(graph.error());
  const Ros2GidSize size = *network.distribution == Ros2Distribution::kHumble ? Ros2GidSize::k24 : Ros2GidSize::k16;
  node.graph_ = std::make_shared<Ros2Graph>(*std::move(graph), size, participant);
  if (const Result<void> told = node.graph_->announce(); !told) return tl::unexpected(told.error());
  return node;
}

Result<Ros2Writer> Ros2Node::write(const Ros2Topic& topic, Ros2Delivery delivery) const {
  constexpr std::int32_t kDepth = 100;
  const Result<dds_entity_t> entity = topic_entity(*participant_, topic);
  if (!entity) return tl::unexpected(entity.error());
  const Qos qos = qos_of(delivery, delivery == Ros2Delivery::kKeepsLast ? 1 : kDepth, topic.type_hash);
  const dds_entity_t writer = dds_create_writer(participant_->entity(), *entity, qos.get(), nullptr);
  if (writer < 0) return dds_error(topic.name, writer);
  if (graph_) {
    if (const Result<void> told = graph_->add_writer(writer); !told) return tl::unexpected(told.error());
  }
  return Ros2Writer(participant_, writer);
}

Result<Ros2Reader> Ros2Node::read(const Ros2Topic& topic, Ros2Delivery delivery) const {
  constexpr std::int32_t kDepth = 100;
  const Result<dds_entity_t> entity = topic_entity(*participant_, topic);
  if (!entity) return tl::unexpected(entity.error());
  const Qos qos = qos_of(delivery, kDepth, topic.type_hash);
  // A reader that asks for more than a writer offers gets nothing.
  if (delivery == Ros2Delivery::kStream) dds_qset_reliability(qos.get(), DDS_RELIABILITY_BEST_EFFORT, 0);
  auto subscription = std::make_shared<Ros2Subscription>(participant_);
  if (const dds_return_t opened = subscription->open(*entity, qos.get()); opened < 0) {
    return dds_error(topic.name, opened);
  }
  if (graph_) {
    if (const Result<void> told = graph_->add_reader(subscription->reader()); !told) {
      return tl::unexpected(told.error());
    }
  }
  return Ros2Reader(std::move(subscription));
}

std::optional<std::string> Ros2Node::type_of(const std::string& topic) const {
  const std::string name = dds_topic(topic);
  std::optional<std::string> type;
  for_each_publication(*participant_, [&](const dds_builtintopic_endpoint_t& endpoint) {
    if (!type && name == endpoint.topic_name) type = ros_type(endpoint.type_name);
  });
  return type;
}

std::vector<std::string> Ros2Node::topics_of_others() const {
  constexpr std::string_view kOfRos = "rt/";
  dds_guid_t own{};
  dds_get_guid(participant_->entity(), &own);
  std::set<std::string> topics;
  for_each_publication(*participant_, [&](const dds_builtintopic_endpoint_t& endpoint) {
    if (std::ranges::equal(endpoint.participant_key.v, own.v)) return;
    const std::string name = endpoint.topic_name;
    topics.insert(name.starts_with(kOfRos) ? name.substr(kOfRos.size() - 1) : name);
  });
  return {topics.begin(), topics.end()};
}

Result<void> Ros2Writer::write(const std::string& message) const {
  const dds_return_t written = dds_write(writer_, &message);
  if (written < 0) return dds_error("message not sent", written);
  return {};
}

int Ros2Reader::descriptor() const {
  return subscription_->descriptor();
}

std::optional<std::string> Ros2Reader::take(double wait_s) const {
  std::optional<Ros2Sample> sample = take_sample(wait_s);
  return sample ? std::optional(std::move(sample->bytes)) : std::nullopt;
}

std::optional<Ros2Sample> Ros2Reader::take_sample(double wait_s) const {
  using Clock = std::chrono::steady_clock;
  const auto until = Clock::now() + std::chrono::duration<double>(wait_s);
  bool may_sleep = false;
  while (true) {
    std::string message;
    void* place = &message;
    dds_sample_info_t info{};
    const dds_return_t count = dds_take(subscription_->reader(), &place, &info, 1, 1);
    if (count > 0 && info.valid_data) {
      strip(message);
      return Ros2Sample{std::move(message), info.publication_handle};
    }
    if (count > 0) continue;
    // What arrives from here on wakes again; what has arrived meanwhile is found by one more look.
    if (!may_sleep) {
      subscription_->sleep_on();
      may_sleep = true;
      continue;
    }
    const double rest_ms = std::chrono::duration<double, std::milli>(until - Clock::now()).count();
    pollfd file = {subscription_->descriptor(), POLLIN, 0};
    if (count < 0 || rest_ms <= 0.0 || ::poll(&file, 1, static_cast<int>(std::ceil(rest_ms))) <= 0) return std::nullopt;
    may_sleep = false;
  }
}

#else

class Ros2Graph {};
class Ros2Participant {};
class Ros2Subscription {};

Result<void> check_ros2_is_built() {
  return fail(Error::Code::kUnsupported,
              "ros2: this pingvox was built without Cyclone DDS: build it where cyclonedds-dev is installed");
}

Result<Ros2Node> Ros2Node::open(const Ros2Network&) {
  return tl::unexpected(check_ros2_is_built().error());
}

Result<Ros2Writer> Ros2Node::write(const Ros2Topic&, Ros2Delivery) const {
  return tl::unexpected(check_ros2_is_built().error());
}

Result<Ros2Reader> Ros2Node::read(const Ros2Topic&, Ros2Delivery) const {
  return tl::unexpected(check_ros2_is_built().error());
}

std::optional<std::string> Ros2Node::type_of(const std::string&) const {
  return std::nullopt;
}

std::vector<std::string> Ros2Node::topics_of_others() const {
  return {};
}

Result<void> Ros2Writer::write(const std::string&) const {
  return tl::unexpected(check_ros2_is_built().error());
}

int Ros2Reader::descriptor() const {
  return -1;
}

std::optional<std::string> Ros2Reader::take(double) const {
  return std::nullopt;
}

std::optional<Ros2Sample> Ros2Reader::take_sample(double) const {
  return std::nullopt;
}

#endif

}  // namespace pingvox
