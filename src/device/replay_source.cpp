#include <cmath>
#include <limits>
#include <utility>

#include "device/internal/live_source.hpp"

namespace pingvox {
namespace {

class ReplaySource final : public LiveSource {
 public:
  ReplaySource(std::unique_ptr<BeamSource> log, double speed) : log_(std::move(log)), speed_(speed) {}

  double due_s() const override { return next_ ? next_at_s_ : -std::numeric_limits<double>::infinity(); }

  Result<bool> step(double now_s, std::vector<Beam>& beams) override {
    // One beam a call: a log at any speed must not fill the memory.
    if (!next_) {
      Result<std::optional<Beam>> beam = log_->next();
      if (!beam) return tl::unexpected(beam.error());
      if (!*beam) return false;
      next_ = std::move(*beam);
      // Clocks that go back, or stand still for more than a minute, are not waited for.
      constexpr double kMaxWait_s = 60.0;
      const double since_last_s = last_time_s_ ? next_->time_s - *last_time_s_ : 0.0;
      const bool waits = since_last_s > 0.0 && since_last_s <= kMaxWait_s && !std::isinf(speed_);
      next_at_s_ = waits ? last_at_s_ + since_last_s / speed_ : last_time_s_ ? last_at_s_ : now_s;
    }
    if (now_s < next_at_s_) return true;
    last_time_s_ = next_->time_s;
    last_at_s_ = next_at_s_;
    beams.push_back(std::move(*next_));
    next_.reset();
    return true;
  }

  void finish(std::vector<Beam>&) override {}

  Result<void> drive(const DrivenHead&) override {
    return fail(Error::Code::kUnsupported, "a replay cannot be changed");
  }

  Result<void> record_to(std::optional<HeadRecorder>) override {
    return fail(Error::Code::kUnsupported, "a replay is already a recording");
  }
  bool is_recording() const override { return false; }

  HeadStatus status() const override {
    HeadStatus status;
    status.is_connected = true;
    status.connections = 1;
    status.damaged = log_->skipped();
    return status;
  }

  const DeviceProfile* device() const override { return log_->device(); }

 private:
  std::unique_ptr<BeamSource> log_;
  double speed_;
  std::optional<Beam> next_;  ///< waits for its time
  double next_at_s_ = 0.0, last_at_s_ = 0.0;
  std::optional<double> last_time_s_;
};

}  // namespace

std::unique_ptr<LiveSource> replay_source(std::unique_ptr<BeamSource> log, double speed) {
  return std::make_unique<ReplaySource>(std::move(log), speed);
}

}  // namespace pingvox
