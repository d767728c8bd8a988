#include <fmt/core.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
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
#include "device/internal/ros2_node.hpp"
#include "device/internal/ros2_publisher_watch.hpp"
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
  /// @return kUnsupported for messages that are not read as beams
  Result<void> start(const std::string& type) {
    const auto next = [this]() -> std::optional<Ros2Arrival> { return wait_for_message(); };
    Result<std::unique_ptr<BeamSource>> beams = read_ros2_beams(topic_, type, next);
    if (!beams) return fail(beams.error().code, fmt::format("ros2:{}: {}", topic_, beams.error().message));
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
    const std::size_t messages = messages_, used = used_;
    const bool has_come = std::exchange(seen_messages_, messages) < messages;
    if (has_come) last_s_ = now_s;
    if (std::exchange(seen_used_, used) < used) {
      if (!std::exchange(status_.is_connected, true)) ++status_.connections;
      status_.refused.clear();
    } else if (now_s > last_s_ + kRos2Silence_s) {
      status_.is_connected = false;
      status_.refused.clear();
      status_.problem = kRos2Silent;
    } else if (has_come && used == 0) {
      const std::lock_guard lock(mutex_);
      if (!refused_.empty()) status_.problem = status_.refused = refused_;
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
    status.publishers = publishers_;
    return status;
  }
  const DeviceProfile* device() const override { return device_; }

 private:
  static constexpr std::size_t kMaxBeams = 4096;  ///< that wait for `step`

  // In the thread.

  std::optional<Ros2Arrival> wait_for_message() {
    constexpr double kLook_s = 0.1;
    judge_messages();
    while (!stop_.stop_requested()) {
      std::optional<Ros2Sample> message = reader_.take_sample(kLook_s);
      if (!message) continue;
      watch_.note(message->publisher, steady_now_s());
      publishers_ = watch_.together();
      ++messages_;
      return Ros2Arrival{system_now_s(), std::move(message->bytes)};
    }
    return std::nullopt;
  }

  /// All that came have been read.
  void judge_messages() {
    constexpr std::size_t kFewDamaged = 3;  // one or two may be chance
    damaged_ = beams_->skipped();
    if (messages_ > damaged_) {
      used_ = messages_ - damaged_;
    } else if (damaged_ >= kFewDamaged) {
      const std::lock_guard lock(mutex_);
      if (refused_.empty()) refused_ = beams_->first_damage();
    }
  }

  void run() {
    while (true) {
      Result<std::optional<Beam>> beam = detail::without_exceptions([&] { return beams_->next(); });
      const bool has_ended = !beam || !*beam;
      const std::lock_guard lock(mutex_);
      if (!beam) error_ = Error{beam.error().code, fmt::format("ros2:{}: {}", topic_, beam.error().message)};
      if (has_ended && beam && !stop_.stop_requested()) {
        error_ = Error{Error::Code::kUnsupported, fmt::format("ros2:{}: its messages are not sonar beams", topic_)};
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
  std::size_t seen_messages_ = 0, seen_used_ = 0;
  double last_s_ = 0.0;
  std::atomic<std::size_t> messages_ = 0, used_ = 0, damaged_ = 0, publishers_ = 0;
  Ros2PublisherWatch watch_;
  std::mutex mutex_;
  std::string refused_;  ///< why none of the messages so far was used
  std::vector<Beam> arrived_;
  std::optional<Error> error_;
  std::stop_token stop_;
  std::jthread thread_;  ///< the last member: it uses the others
};

}  // namespace

Result<void> wait_for_ros2_topic(const Ros2Node& node, const std::string& topic, const KeepWaiting& keep_waiting) {
  constexpr double kLong_s = 5.0, kLongest_s = 10.0;
  constexpr std::chrono::milliseconds kPause(50);
  std::string problem;
  const double start_s = steady_now_s();
  while (!node.type_of(topic)) {
    const double waited_s = steady_now_s() - start_s;
    if (waited_s > kLong_s && problem.empty()) problem = fmt::format("ros2:{}: {}", topic, why_not_published(node));
    const bool goes_on = keep_waiting ? keep_waiting(problem) : waited_s < kLongest_s;
    if (!goes_on) return fail(Error::Code::kIo, fmt::format("ros2:{}: {}", topic, why_not_published(node)));
    std::this_thread::sleep_for(kPause);
  }
  return {};
}

Result<std::unique_ptr<LiveSource>> ros2_source(const Ros2Node& node, const std::string& topic, double since_1970_s) {
  const std::optional<std::string> type = node.type_of(topic);
  if (!type) return fail(Error::Code::kIo, fmt::format("ros2:{}: {}", topic, why_not_published(node)));
  Result<Ros2Reader> reader = node.read({topic, *type}, Ros2Delivery::kStream);
  if (!reader) return tl::unexpected(reader.error());
  auto source = std::make_unique<Ros2Source>(topic, *type, *std::move(reader), since_1970_s);
  if (const auto started = source->start(*type); !started) return tl::unexpected(started.error());
  return std::unique_ptr<LiveSource>(std::move(source));
}

}  // namespace pingvox
