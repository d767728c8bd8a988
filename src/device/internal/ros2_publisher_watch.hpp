#pragma once

#include <cstddef>
#include <cstdint>
#include <map>

namespace pingvox {

/// Detects by the messages of a topic that several publishers send it at the same time: each returns after another one.
/// One that was restarted has a new number, and the old one does not return.
class Ros2PublisherWatch {
 public:
  /// Notes a message. @param now_s  of a clock that never goes back
  void note(std::uint64_t publisher, double now_s);

  /// Most that sent at the same time; 0: at most one.
  std::size_t together() const { return together_; }

 private:
  struct Known {
    double since_s = 0.0;
    std::size_t returns = 0;  ///< since then, after messages of others
  };
  std::map<std::uint64_t, Known> known_;
  std::uint64_t last_ = 0;
  std::size_t together_ = 0;
};

}  // namespace pingvox
