#include <algorithm>
#include <array>
#include <deque>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include "device/internal/guarded_recorder.hpp"
#include "device/internal/link.hpp"
#include "device/internal/live_source.hpp"
#include "device/listening_drivers.hpp"
#include "device/micron_driver.hpp"
#include "device/ping360_driver.hpp"
#include "device/read_limit.hpp"
#include "io/internal/frame_finder.hpp"
#include "io/internal/ping_frame.hpp"
#include "io/internal/seanet_frame.hpp"

namespace pingvox {
namespace {

constexpr double kFirstDelay_s = 0.5, kMaxDelay_s = 10.0, kRest_s = 0.1;
/// From one look at a name that is being looked up to the next.
constexpr double kLookUp_s = 0.05;

/// Properties of a head that HeadSource needs.
struct Ping360Head {
  using Settings = Ping360Settings;
  using Driver = Ping360Driver;
  using Recorder = PingViewerRecorder;
  static constexpr const char* kDevice = "ping360";
  static constexpr CheckFrame kCheck = check_ping_frame;
  static constexpr auto kBeamIn = ping_beam_in;
  static constexpr bool kIsBrokenWhole = true;  ///< a damaged frame is known by its checksum, which comes last

  /// Sent at the end; empty: nothing.
  static std::vector<std::uint8_t> last_message() { return Ping360Driver::motor_off(); }
};

struct MicronHead {
  using Settings = MicronSettings;
  using Driver = MicronDriver;
  using Recorder = SeanetRecorder;
  static constexpr const char* kDevice = "micron";
  static constexpr CheckFrame kCheck = check_seanet_frame;
  static constexpr auto kBeamIn = seanet_beam_in;
  static constexpr bool kIsBrokenWhole = false;
  // It stands still when it is not asked.
  static std::vector<std::uint8_t> last_message() { return {}; }
};

/// A Ping360 that another program drives.
template <class Listener>
struct SharedHead {
  using Settings = typename Listener::Settings;
  using Driver = Listener;
  using Recorder = PingViewerRecorder;
  static constexpr const char* kDevice = "ping360";
  static constexpr CheckFrame kCheck = check_ping_frame;
  static constexpr auto kBeamIn = ping_beam_in;
  static constexpr bool kIsBrokenWhole = true;
  // The other program goes on.
  static std::vector<std::uint8_t> last_message() { return {}; }
};
using SharedPing360Head = SharedHead<Ping360Listener>;  // at the bridge of BlueOS
using PingViewer2Head = SharedHead<PingViewer2Client>;  // at the server of Ping Viewer 2

/// A driver whose line holds something else than frames.
template <class Driver>
concept UnpacksFrames = requires(Driver driver, std::span<const std::uint8_t> bytes) { driver.frames_in(bytes); };

template <class Head>
class HeadSource final : public LiveSource {
 public:
  HeadSource(std::string address, const typename Head::Settings& settings,
             std::optional<typename Head::Recorder> recorder, double now_s)
      : address_(std::move(address)),
        driver_(settings),
        recorder_(std::move(recorder)),
        finder_(Head::kCheck),
        start_s_(now_s),
        open_at_s_(now_s) {}

  int descriptor() const override { return link_ ? link_->descriptor() : -1; }

  double due_s() const override {
    const double due_s = link_ ? std::max(driver_.due_s(), connects_until_s_) : open_at_s_;
    return std::min(due_s, recorder_.sync_due_s());
  }

  Result<bool> step(double now_s, std::vector<Beam>& beams) override {
    if (!link_ && now_s >= open_at_s_) open(now_s);
    if (link_) read(now_s, beams);
    if (link_) send(now_s);
    recorder_.sync_if_due(now_s);
    return true;
  }

  void finish(std::vector<Beam>& beams) override {
    const std::vector<std::uint8_t> last = Head::last_message();
    if (link_ && !last.empty()) static_cast<void>(link_->write(last));  // the head may be gone
    finder_.end();
    take_frames(beams);
  }

  Result<void> drive(const DrivenHead& settings) override {
    if constexpr (!std::is_constructible_v<DrivenHead, typename Head::Settings>) {
      return fail(Error::Code::kUnsupported, address_ + ": another program drives the head");
    } else {
      const auto* const of_head = std::get_if<typename Head::Settings>(&settings);
      if (of_head == nullptr)
        return fail(Error::Code::kUnsupported, address_ + ": these settings are for another head");
      driver_.drive(*of_head);
      return {};
    }
  }

  Result<void> record_to(std::optional<HeadRecorder> recorder) override {
    if (!recorder) {
      recorder_.record_to(std::nullopt);
      return {};
    }
    auto* const of_head = std::get_if<typename Head::Recorder>(&*recorder);
    if (of_head == nullptr) return fail(Error::Code::kUnsupported, address_ + ": this recorder is for another head");
    recorder_.record_to(std::move(*of_head));
    return {};
  }
  bool is_recording() const override { return recorder_.is_recording(); }

  HeadStatus status() const override {
    HeadStatus status = status_;
    status.is_connected = link_ && driver_.is_connected();
    status.unanswered = driver_.unanswered();
    status.damaged += damage_count(finder_.damage()) + unusable_;
    if constexpr (UnpacksFrames<typename Head::Driver>) {
      status.unexpected += driver_.left_out();
      status.first_unexpected = driver_.first_left_out();
    }
    if constexpr (std::is_same_v<typename Head::Driver, Ping360Listener>) {
      if (link_ && !status.is_connected) status.problem = driver_.problem();
    }
    status.recording_error = recorder_.error();
    return status;
  }

  const DeviceProfile* device() const override { return find_device(Head::kDevice); }

 private:
  void open(double now_s) {
    if (!opening_) opening_.emplace(address_);
    std::optional<Result<Link>> link = opening_->take();
    if (!link) {
      open_at_s_ = now_s + kLookUp_s;
      return;
    }
    opening_.reset();
    if (!*link) return close(link->error().message, now_s);
    link_ = *std::move(*link);
    driver_.connect();
  }

  void close(std::string problem, double now_s) {
    status_.problem = std::move(problem);
    link_.reset();
    open_at_s_ = now_s + delay_s_;
    delay_s_ = std::min(2.0 * delay_s_, kMaxDelay_s);
  }

  void read(double now_s, std::vector<Beam>& beams) {
    std::array<std::uint8_t, 65536> bytes;
    for (ReadLimit limit; limit.allows_more();) {
      const Result<std::size_t> got = link_->read(bytes);
      limit.count(got.value_or(0));
      if (!got) return close(got.error().message, now_s);
      if (*got == 0) return;
      take(std::span(bytes).first(*got), now_s, beams);
    }
  }

  void send(double now_s) {
    if constexpr (UnpacksFrames<typename Head::Driver>) {
      // A request that is lost would not be repeated.
      if (link_->is_connecting()) connects_until_s_ = now_s + kLookUp_s;
      if (link_->is_connecting()) return;
    }
    const std::optional<std::vector<std::uint8_t>> message = driver_.message(now_s);
    if (driver_.is_lost()) return close(address_ + ": " + driver_.problem(), now_s);
    if (!message) return;
    if (const auto sent = link_->write(*message); !sent) close(sent.error().message, now_s);
  }

  void take(std::span<const std::uint8_t> bytes, double now_s, std::vector<Beam>& beams) {
    if constexpr (UnpacksFrames<typename Head::Driver>) bytes = driver_.frames_in(bytes);
    if (bytes.empty()) return;
    const auto time_ms = static_cast<std::uint64_t>((now_s - start_s_) * 1000.0);
    recorder_.append(time_ms, bytes);
    received_ += bytes.size();
    pieces_.push_back({received_, recorded_time_s(time_ms)});
    finder_.push(bytes);
    const std::size_t broken = broken_frames();
    // The bytes of an answer come without a break.
    double rest_until_s = now_s + kRest_s;
    if (take_frames(beams)) {
      rest_until_s = std::numeric_limits<double>::infinity();
    } else if (Head::kIsBrokenWhole && broken_frames() > broken) {
      rest_until_s = now_s;
    }
    driver_.expect_rest(rest_until_s);
  }

  std::size_t broken_frames() const {
    std::size_t count = 0;
    for (const DamageKind& kind : finder_.damage()) count += kind.what != FrameFinder::kBetween ? kind.count : 0;
    return count;
  }

  /// Whether there were any.
  bool take_frames(std::vector<Beam>& beams) {
    bool has_frame = false;
    while (const std::optional<FrameFinder::Frame> frame = finder_.next()) {
      has_frame = true;
      // Before the driver goes on to its next request.
      const std::optional<std::string> contradiction = driver_.contradiction(frame->bytes);
      const bool was_connected = driver_.is_connected();
      driver_.take(frame->bytes);
      if (driver_.is_connected() && !was_connected) ++status_.connections;
      tl::expected<std::optional<Beam>, std::string> beam = Head::kBeamIn(frame->bytes, time_of(*frame));
      if (beam && !*beam) continue;
      delay_s_ = kFirstDelay_s;
      if (!beam) {
        ++unusable_;
      } else if (contradiction) {
        if (status_.unexpected++ == 0) status_.first_unexpected = *contradiction;
      } else {
        beams.push_back(*std::move(*beam));
      }
    }
    while (pieces_.size() > 1 && pieces_.front().end <= finder_.position()) pieces_.pop_front();
    return has_frame;
  }

  /// Time of the read that brought the frame's last byte, as readers of the recording have it.
  double time_of(const FrameFinder::Frame& frame) const {
    const auto piece = std::ranges::find_if(pieces_, [&](const Piece& p) { return p.end >= frame.end(); });
    return piece != pieces_.end() ? piece->time_s : pieces_.back().time_s;
  }

  struct Piece {
    std::uint64_t end;  ///< in the stream of bytes
    double time_s;
  };

  std::string address_;
  typename Head::Driver driver_;
  GuardedRecorder<typename Head::Recorder> recorder_;
  std::optional<LinkOpening> opening_;
  std::optional<Link> link_;
  FrameFinder finder_;
  std::deque<Piece> pieces_;  ///< that unprocessed bytes came with
  std::uint64_t received_ = 0;
  std::size_t unusable_ = 0;
  HeadStatus status_;
  double start_s_, open_at_s_, delay_s_ = kFirstDelay_s;
  double connects_until_s_ = -std::numeric_limits<double>::infinity();  ///< looked at again then
};

}  // namespace

std::unique_ptr<LiveSource> ping360_source(const std::string& address, const Ping360Settings& settings,
                                           std::optional<PingViewerRecorder> recorder, double now_s) {
  return std::make_unique<HeadSource<Ping360Head>>(address, settings, std::move(recorder), now_s);
}

std::unique_ptr<LiveSource> shared_ping360_source(const std::string& address,
                                                  std::optional<PingViewerRecorder> recorder, double now_s) {
  return std::make_unique<HeadSource<SharedPing360Head>>(address, Ping360Listener::Settings{}, std::move(recorder),
                                                         now_s);
}

std::unique_ptr<LiveSource> ping_viewer_2_source(const std::string& address, const std::string& device,
                                                 std::optional<PingViewerRecorder> recorder, double now_s) {
  const PingViewer2Client::Settings settings{address.substr(address.find("://") + 3), device};
  return std::make_unique<HeadSource<PingViewer2Head>>(address, settings, std::move(recorder), now_s);
}

std::unique_ptr<LiveSource> micron_source(const std::string& address, const MicronSettings& settings,
                                          std::optional<SeanetRecorder> recorder, double now_s) {
  return std::make_unique<HeadSource<MicronHead>>(address, settings, std::move(recorder), now_s);
}

}  // namespace pingvox
