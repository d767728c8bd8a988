#include <fmt/core.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <iterator>
#include <limits>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include "base/without_exceptions.hpp"
#include "device/internal/live_source.hpp"
#include "device/internal/ros2_nav_receiver.hpp"
#include "device/internal/ros2_node.hpp"
#include "device/ros2_time.hpp"
#include "io/internal/descriptor.hpp"
#include "io/internal/ros2_topics.hpp"

namespace pingvox {
namespace {

/// The beams of a topic. They are read by a thread: readers of bags wait for the next message.
class Ros2Source final : public LiveSource {
 public:
  Ros2Source(std::string topic, const std::string& type, Ros2Reader reader, double since_1970_s)
      : topic_(std::move(topic)),
        device_(device_of_ros2_type(type)),
        reader_(std::move(reader)),
        since_1970_s_(since_1970_s),
        event_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}

  /// REQUIRES that it stays where it is.
  Result<void> start(const std::string& type) {
    const auto next = [this]() -> std::optional<Ros2Arrival> { return wait_for_message(); };
    Result<std::unique_ptr<BeamSource>> beams = read_ros2_beams(topic_, type, next);
    if (!beams) return tl::unexpected(beams.error());
    beams_ = *std::move(beams);
    try {
      thread_ = std::jthread([this](const std::stop_token& stop) {
        stop_ = stop;
        run();
      });
    } catch (const std::system_error& error) {
      return fail(Error::Code::kIo, fmt::format("ros2:{}: no thread: {}", topic_, error.what()));
    }
    return {};
  }

  int descriptor() const override { return event_.get(); }
  double due_s() const override { return std::numeric_limits<double>::infinity(); }

  Result<bool> step(double now_s, std::vector<Beam>& beams) override {
    std::uint64_t count = 0;
    static_cast<void>(::read(event_.get(), &count, sizeof count));
    if (const std::size_t messages = messages_; messages > seen_messages_) {
      seen_messages_ = messages;
      last_s_ = now_s;
      if (!std::exchange(status_.is_connected, true)) ++status_.connections;
    } else if (now_s > last_s_ + kRos2Silence_s) {
      status_.is_connected = false;
      status_.problem = kRos2Silent;
    }
    return take(beams);
  }

  void finish(std::vector<Beam>& beams) override {
    thread_.request_stop();
    if (thread_.joinable()) thread_.join();
    static_cast<void>(take(beams));
  }

  Result<void> drive(const DrivenHead&) override {
    return fail(Error::Code::kUnsupported, fmt::format("ros2:{}: another program drives the head", topic_));
  }
  Result<void> record_to(std::optional<HeadRecorder> recorder) override {
    if (!recorder) return {};
    return fail(Error::Code::kUnsupported, fmt::format("ros2:{}: is not recorded: use 'ros2 bag record'", topic_));
  }
  bool is_recording() const override { return false; }

  HeadStatus status() const override {
    HeadStatus status = status_;
    status.damaged = damaged_;
    return status;
  }
  const DeviceProfile* device() const override { return device_; }

 private:
  static constexpr std::size_t kMaxBeams = 4096;  ///< that wait for `step`

  // In the thread.

  std::optional<Ros2Arrival> wait_for_message() {
    constexpr double kLook_s = 0.1;
    while (!stop_.stop_requested()) {
      std::optional<std::string> message = reader_.take(kLook_s);
      if (!message) continue;
      ++messages_;
      return Ros2Arrival{system_now_s(), *std::move(message)};
    }
    return std::nullopt;
  }

  void run() {
    while (true) {
      Result<std::optional<Beam>> beam = detail::without_exceptions([&] { return beams_->next(); });
      damaged_ = beams_->skipped();
      const bool has_ended = !beam || !*beam;
      const std::lock_guard lock(mutex_);
      if (!beam) error_ = beam.error();
      if (has_ended && beam && !stop_.stop_requested()) {
        error_ =
            Error{Error::Code::kUnsupported, fmt::format("ros2:{}: its messages are not beams of a sonar", topic_)};
      }
      if (!has_ended && arrived_.size() < kMaxBeams) arrived_.push_back(**std::move(beam));
      constexpr std::uint64_t kOnce = 1;
      static_cast<void>(::write(event_.get(), &kOnce, sizeof kOnce));
      if (has_ended) return;
    }
  }

  // In the thread of the caller.

  Result<bool> take(std::vector<Beam>& beams) {
    std::vector<Beam> arrived;
    std::optional<Error> error;
    {
      const std::lock_guard lock(mutex_);
      arrived = std::exchange(arrived_, {});
      error = error_;
    }
    for (Beam& beam : arrived) beam.time_s -= since_1970_s_;
    beams.insert(beams.end(), std::make_move_iterator(arrived.begin()), std::make_move_iterator(arrived.end()));
    if (error) return tl::unexpected(*error);
    return true;
  }

  std::string topic_;
  const DeviceProfile* device_;
  Ros2Reader reader_;
  double since_1970_s_;
  Descriptor event_;
  std::unique_ptr<BeamSource> beams_;
  HeadStatus status_;
  std::size_t seen_messages_ = 0;
  double last_s_ = 0.0;
  std::atomic<std::size_t> messages_ = 0, damaged_ = 0;
  std::mutex mutex_;
  std::vector<Beam> arrived_;
  std::optional<Error> error_;
  std::stop_token stop_;
  std::jthread thread_;  ///< the last member: it uses the others
};

}  // namespace

Result<std::unique_ptr<LiveSource>> ros2_source(const Ros2Node& node, const std::string& topic, double since_1970_s) {
  const Result<std::string> type = wait_for_type(node, topic);
  if (!type) return tl::unexpected(type.error());
  Result<Ros2Reader> reader = node.read({topic, *type}, Ros2Delivery::kStream);
  if (!reader) return tl::unexpected(reader.error());
  auto source = std::make_unique<Ros2Source>(topic, *type, *std::move(reader), since_1970_s);
  if (const auto started = source->start(*type); !started) return tl::unexpected(started.error());
  return std::unique_ptr<LiveSource>(std::move(source));
}

}  // namespace pingvox
