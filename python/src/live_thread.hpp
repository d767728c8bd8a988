#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include "io/internal/descriptor.hpp"
#include "pingvox/live/live_event.hpp"
#include "pingvox/live/live_mapping.hpp"
#include "pingvox/live/live_options.hpp"
#include "pingvox/result.hpp"

namespace pingvox::python {

/// An event, and what the program says of it.
struct ReportedEvent {
  LiveEvent event;
  std::string text;
};

/// Runs a LiveMapping in a thread of its own: a head waits for nobody, and Python code may take long. No function needs
/// the lock of the interpreter, nor does the thread ever take it.
class LiveThread {
 public:
  /// @return errors of LiveMapping::open; kIo where no thread can be had
  static Result<std::unique_ptr<LiveThread>> open(const LiveOptions& options);
  /// As `end`, then waits for the end.
  ~LiveThread();
  LiveThread(const LiveThread&) = delete;
  LiveThread& operator=(const LiveThread&) = delete;

  /// Calls f(live) in the thread between two steps, after the end of the run at once. It must own all that it uses, as
  /// whoever waits for its result may be interrupted.
  template <class F>
  std::future<std::invoke_result_t<F, LiveMapping&>> call(F f) {
    using Task = std::packaged_task<std::invoke_result_t<F, LiveMapping&>(LiveMapping&)>;
    auto task = std::make_shared<Task>(std::move(f));  // std::function has to be copied
    auto result = task->get_future();
    post([task](LiveMapping& live) { (*task)(live); });
    return result;
  }

  /// Asks the run to end: it stops the head and maps the beams that wait.
  void end();

  /// Waits for an event or the end of the run, some time at most.
  /// @return the first event that was not taken yet; nullopt: none, or the run has ended without one
  std::optional<ReportedEvent> take_event(std::chrono::milliseconds longest);
  std::vector<ReportedEvent> take_events();
  /// Waits for the end of the run, some time at most.
  /// @return nullopt: the run goes on. Else the error of LiveMapping::step or `finish`.
  std::optional<Result<void>> ended(std::chrono::milliseconds longest = std::chrono::milliseconds(0));

 private:
  LiveThread(LiveMapping live, LiveOptions options, Descriptor wake);
  void run();
  void post(std::function<void(LiveMapping&)> task);
  void wake() const;
  void do_tasks();
  void tell_events();

  LiveMapping live_;  ///< of the thread; after its end of who holds the mutex
  LiveOptions options_;
  Descriptor wake_;  ///< eventfd that ends a wait of `live_`
  std::mutex mutex_;
  std::condition_variable told_;  ///< there is an event, or the run has ended
  // With the mutex:
  std::deque<std::function<void(LiveMapping&)>> tasks_;
  std::deque<ReportedEvent> events_;
  bool is_ending_ = false;
  std::optional<Result<void>> ended_;
  std::thread thread_;  ///< the last one, as it uses the others
};

}  // namespace pingvox::python
