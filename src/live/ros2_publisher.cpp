#include "live/ros2_publisher.hpp"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <new>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/option_errors.hpp"
#include "io/internal/ros2_messages.hpp"

namespace pingvox {
namespace {

constexpr std::string_view kOdometry = "/odometry", kTf = "/tf";
constexpr std::string_view kOdometryType = "nav_msgs/msg/Odometry", kTfType = "tf2_msgs/msg/TFMessage";

std::uint64_t ns_of(double since_1970_s) {
  constexpr double kNs_per_s = 1e9;
  return static_cast<std::uint64_t>(std::llround(std::max(since_1970_s, 0.0) * kNs_per_s));
}

/// Between two poses, in the frame of the vehicle. None from one that is long ago.
Ros2Twist twist_of(const StampedPose& from, const StampedPose& to) {
  constexpr double kLongest_s = 1.0;
  const double time_s = to.time_s - from.time_s;
  if (!(time_s > 0.0 && time_s <= kLongest_s)) return {};
  const Pose step = from.map_from_body.inverse() * to.map_from_body;
  const Eigen::AngleAxisd turn(step.rotation());
  return {step.translation() / time_s, turn.angle() / time_s * turn.axis()};
}

}  // namespace

Result<void> Ros2Publish::validate() const {
  OptionErrors errors;
  errors.require(prefix.empty() || is_ros2_topic("/" + prefix), "prefix", "a name of ROS as in \"vehicle/pingvox\"",
                 prefix);
  errors.require(!frame.empty(), "frame", "a name", "empty");
  errors.require(!body_frame.empty(), "body_frame", "a name", "empty");
  errors.require_within("every_s", every_s, 0.1, 86'400.0);
  return errors.result("publish");
}

std::string Ros2Publish::topic(const std::string& name) const {
  return prefix.empty() ? name : "/" + prefix + name;
}

/// What the threads use: it stays where it is while the publisher moves.
struct Ros2Publisher::Shared {
  std::vector<Ros2Writer> maps;  ///< of kRos2MapTopics
  Ros2Writer odometry;
  std::optional<Ros2Writer> tf;
  std::atomic<double> map_s = 0.0;  ///< how long the last one took
  mutable std::mutex mutex;
  std::string problem;
  TaskThread map_thread, pose_thread;  ///< the last members: they use the others

  Shared(std::vector<Ros2Writer> of_maps, Ros2Writer of_odometry, std::optional<Ros2Writer> of_tf)
      : maps(std::move(of_maps)), odometry(std::move(of_odometry)), tf(std::move(of_tf)) {}

  void set_problem(const Result<void>& written) {
    const std::lock_guard lock(mutex);
    problem = written ? std::string() : written.error().message;
  }

  Result<void> write_map(const OccupancyMap& map, std::uint64_t time_ns, const std::string& frame) const {
    const Result<std::vector<Ros2Message>> messages = ros2_map_messages(map, time_ns, frame);
    // Nothing is occupied yet.
    if (!messages && messages.error().code == Error::Code::kUnsupported) return {};
    if (!messages) return tl::unexpected(messages.error());
    Result<void> all;
    for (std::size_t i = 0; i < messages->size(); ++i) {
      if (Result<void> written = maps[i].write((*messages)[i].bytes); !written) all = std::move(written);
    }
    return all;
  }
};

Ros2Publisher::Ros2Publisher(std::unique_ptr<Shared> shared, const Ros2Publish& options)
    : shared_(std::move(shared)), options_(options) {}
Ros2Publisher::Ros2Publisher(Ros2Publisher&&) noexcept = default;
Ros2Publisher& Ros2Publisher::operator=(Ros2Publisher&&) noexcept = default;
Ros2Publisher::~Ros2Publisher() = default;

Result<Ros2Publisher> Ros2Publisher::open(const Ros2Node& node, const Ros2Publish& options, PublishTf tf) {
  const auto writer_of = [&](const std::string& name, std::string_view type, Ros2Delivery delivery) {
    return node.write({name, std::string(type), std::string(ros2_type_hash(type))}, delivery);
  };
  std::vector<Ros2Writer> maps;
  for (const Ros2MapTopic& topic : kRos2MapTopics) {
    Result<Ros2Writer> writer = writer_of(options.topic(std::string(topic.name)), topic.type, Ros2Delivery::kKeepsLast);
    if (!writer) return tl::unexpected(writer.error());
    maps.push_back(*std::move(writer));
  }
  Result<Ros2Writer> odometry = writer_of(options.topic(std::string(kOdometry)), kOdometryType, Ros2Delivery::kStream);
  if (!odometry) return tl::unexpected(odometry.error());
  std::optional<Ros2Writer> transforms;
  if (tf == PublishTf::kYes) {
    Result<Ros2Writer> writer = writer_of(std::string(kTf), kTfType, Ros2Delivery::kStream);
    if (!writer) return tl::unexpected(writer.error());
    transforms = *std::move(writer);
  }
  try {
    auto shared = std::make_unique<Shared>(std::move(maps), *std::move(odometry), std::move(transforms));
    return Ros2Publisher(std::move(shared), options);
  } catch (const std::system_error& error) {
    return fail(Error::Code::kIo, fmt::format("publish: no thread: {}", error.what()));
  }
}

bool Ros2Publisher::is_map_due(double now_s) const {
  return now_s >= map_due_s_ && shared_->map_thread.waiting() == 0;
}

void Ros2Publisher::publish_map(const OccupancyMap& map, double now_s, double since_1970_s) {
  constexpr double kShare = 10.0;
  map_due_s_ = now_s + std::max(options_.every_s, kShare * shared_->map_s);
  const auto write = [shared = shared_.get(), copy = std::make_shared<const OccupancyMap>(map),
                      time_ns = ns_of(since_1970_s), frame = options_.frame] {
    const auto start = std::chrono::steady_clock::now();
    try {
      shared->set_problem(shared->write_map(*copy, time_ns, frame));
    } catch (const std::bad_alloc&) {
      shared->set_problem(fail(Error::Code::kNoMemory, "map not published: out of memory"));
    }
    shared->map_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  shared_->map_thread.add(write);
}

void Ros2Publisher::publish_pose(const StampedPose& pose, double since_1970_s) {
  constexpr double kEvery_s = 0.05;
  constexpr std::size_t kMaxWaiting = 100;  // a reader that is slow gets fewer
  if (last_ && pose.time_s < last_->time_s + kEvery_s && pose.time_s >= last_->time_s) return;
  const Ros2Twist twist = last_ ? twist_of(*last_, pose) : Ros2Twist{};
  last_ = pose;
  if (shared_->pose_thread.waiting() >= kMaxWaiting) return;
  const std::uint64_t time_ns = ns_of(since_1970_s);
  const auto write = [shared = shared_.get(),
                      odometry = ros2_odometry(time_ns, options_.frame, options_.body_frame, pose.map_from_body, twist),
                      transform = ros2_transform(time_ns, options_.frame, options_.body_frame, pose.map_from_body)] {
    // One that is not sent is followed by the next.
    static_cast<void>(shared->odometry.write(odometry));
    if (shared->tf) static_cast<void>(shared->tf->write(transform));
  };
  shared_->pose_thread.add(write);
}

void Ros2Publisher::finish() {
  shared_->map_thread.wait();
  shared_->pose_thread.wait();
}

std::string Ros2Publisher::problem() const {
  const std::lock_guard lock(shared_->mutex);
  return shared_->problem;
}

}  // namespace pingvox
