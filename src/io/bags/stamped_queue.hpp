#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <utility>

namespace pingvox {

/// When a message was made by its stamp, and when it was recorded.
struct MessageTime {
  double stamp_s = 0.0, recorded_s = 0.0;
};

/// Tells whether the stamps of a topic stand still: they are the same for seconds while messages are recorded, because
/// the driver sets them once or seldom. They say nothing then.
class StampWatch {
 public:
  /// The next message.
  void add(const MessageTime& time) {
    constexpr double kLongest_s = 2.0;
    constexpr std::size_t kMinCount = 3;
    if (count_ > 0) {
      const double step_s = time.recorded_s - recorded_s_;
      all_s_ += step_s;
      if (time.stamp_s == stamp_s_) still_s_ += step_s;
    }
    recorded_s_ = time.recorded_s;
    if (count_ == 0 || time.stamp_s != stamp_s_) {
      stamp_s_ = time.stamp_s;
      since_s_ = time.recorded_s;
      count_ = 0;
    }
    ++count_;
    stand_still_ = stand_still_ || (count_ >= kMinCount && time.recorded_s - since_s_ > kLongest_s);
  }
  bool stand_still() const { return stand_still_; }
  /// The same for most of the recording: not where a message is only sent once more, as the last fix of a receiver.
  bool mostly_stand_still() const { return stand_still_ && 2.0 * still_s_ > all_s_; }

 private:
  double stamp_s_ = 0.0, since_s_ = 0.0, recorded_s_ = 0.0;
  double still_s_ = 0.0, all_s_ = 0.0;
  std::size_t count_ = 0;  ///< of messages with this stamp
  bool stand_still_ = false;
};

/// What the messages of a topic hold, in their order, as soon as their times are known: by their stamps, or once these
/// stand still by the recording.
template <class T>
class StampedQueue {
 public:
  void add(T item, const MessageTime& time) {
    // A stamp that changed is a time, and so were those before it.
    if (!items_.empty() && items_.back().second.stamp_s != time.stamp_s) known_ = items_.size();
    items_.emplace_back(std::move(item), time);
    watch_.add(time);
    constexpr std::size_t kMaxItems = 4096;
    if (watch_.stand_still() || items_.size() > kMaxItems) known_ = items_.size();
  }
  /// No more are added.
  void end() { known_ = items_.size(); }

  /// The next one whose time is known, and by how much that is later than its stamp.
  std::optional<std::pair<T, double>> take() {
    if (known_ == 0) return std::nullopt;
    auto [item, time] = std::move(items_.front());
    items_.pop_front();
    --known_;
    return std::pair(std::move(item), watch_.stand_still() ? time.recorded_s - time.stamp_s : 0.0);
  }
  bool stamps_stand_still() const { return watch_.stand_still(); }

 private:
  std::deque<std::pair<T, MessageTime>> items_;
  std::size_t known_ = 0;  ///< items whose times are known
  StampWatch watch_;
};

}  // namespace pingvox
