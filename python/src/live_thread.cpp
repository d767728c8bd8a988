#include "live_thread.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>

#include "base/without_exceptions.hpp"
#include "live_event_text.hpp"

namespace pingvox::python {

Result<std::unique_ptr<LiveThread>> LiveThread::open(const LiveOptions& options) {
  return detail::without_exceptions([&]() -> Result<std::unique_ptr<LiveThread>> {
    Descriptor wake(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC));
    if (!wake.valid()) return os_error("live", errno);
    Result<LiveMapping> live = LiveMapping::open(options);
    if (!live) return tl::unexpected(live.error());
    std::unique_ptr<LiveThread> made(new LiveThread(*std::move(live), options, std::move(wake)));
    made->thread_ = std::thread([thread = made.get()] { thread->run(); });
    return made;
  });
}

LiveThread::LiveThread(LiveMapping live, LiveOptions options, Descriptor wake)
    : live_(std::move(live)), options_(std::move(options)), wake_(std::move(wake)) {}

LiveThread::~LiveThread() {
  end();
  if (thread_.joinable()) thread_.join();
}

void LiveThread::run() {
  Result<bool> goes_on = true;
  const auto is_ending = [this] {
    const std::lock_guard lock(mutex_);
    return is_ending_;
  };
  while (goes_on.value_or(false) && !is_ending()) {
    live_.wait(1.0, wake_.get());
    do_tasks();
    goes_on = live_.step();
    tell_events();
  }
  Result<void> finished = live_.finish();
  if (!goes_on) finished = tl::unexpected(goes_on.error());
  tell_events();
  const std::lock_guard lock(mutex_);
  for (const auto& task : tasks_) task(live_);
  tasks_.clear();
  ended_ = std::move(finished);
  told_.notify_all();
}

void LiveThread::post(std::function<void(LiveMapping&)> task) {
  const std::lock_guard lock(mutex_);
  if (ended_) {
    task(live_);
  } else {
    tasks_.push_back(std::move(task));
    wake();
  }
}

void LiveThread::wake() const {
  constexpr std::uint64_t kOne = 1;
  // It fails only where the event is set already.
  static_cast<void>(::write(wake_.get(), &kOne, sizeof kOne));
}

void LiveThread::do_tasks() {
  std::deque<std::function<void(LiveMapping&)>> tasks;
  {
    const std::lock_guard lock(mutex_);
    tasks.swap(tasks_);
    std::uint64_t count = 0;
    // It fails only where the event is not set.
    static_cast<void>(::read(wake_.get(), &count, sizeof count));
  }
  for (const auto& task : tasks) task(live_);
}

void LiveThread::tell_events() {
  std::vector<LiveEvent> events = live_.take_events();
  if (events.empty()) return;
  const LiveStatus status = live_.status();
  constexpr std::size_t kMaxEvents = 1000;  // as LiveMapping keeps
  const std::lock_guard lock(mutex_);
  for (LiveEvent& event : events) {
    if (events_.size() >= kMaxEvents) break;
    std::string text = app::live_event_text(event, options_, status);
    events_.push_back({std::move(event), std::move(text)});
  }
  told_.notify_all();
}

void LiveThread::end() {
  const std::lock_guard lock(mutex_);
  is_ending_ = true;
  wake();
}

std::optional<ReportedEvent> LiveThread::take_event(std::chrono::milliseconds longest) {
  std::unique_lock lock(mutex_);
  told_.wait_for(lock, longest, [this] { return ended_ || !events_.empty(); });
  if (events_.empty()) return std::nullopt;
  ReportedEvent first = std::move(events_.front());
  events_.pop_front();
  return first;
}

std::vector<ReportedEvent> LiveThread::take_events() {
  const std::lock_guard lock(mutex_);
  const std::deque<ReportedEvent> events = std::exchange(events_, {});
  return {events.begin(), events.end()};
}

std::optional<Result<void>> LiveThread::ended(std::chrono::milliseconds longest) {
  std::unique_lock lock(mutex_);
  told_.wait_for(lock, longest, [this] { return ended_.has_value(); });
  return ended_;
}

}  // namespace pingvox::python
