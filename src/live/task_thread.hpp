#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>

namespace pingvox {

/// Runs tasks one after the other in a thread of its own. The destructor waits for the running one and drops others.
class TaskThread {
 public:
  using Task = std::function<void()>;

  /// @throws std::system_error when the thread cannot be started
  TaskThread() : thread_([this](const std::stop_token& stop) { run(stop); }) {}

  /// Tasks that do not throw.
  void add(Task task);
  /// How many tasks have not ended.
  std::size_t waiting() const;
  /// Waits until all have ended.
  void wait();

 private:
  void run(const std::stop_token& stop);

  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Task> tasks_;  ///< the first one runs
  std::jthread thread_;     ///< the last member: it uses the others
};

}  // namespace pingvox
