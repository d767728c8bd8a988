#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "pingvox/device/head_settings.hpp"
#include "pingvox/live/live_mapping.hpp"
#include "pingvox/result.hpp"
#include "pingvox/web/answer.hpp"

namespace pingvox::web {

/// Commands from a page with the token.
namespace live_control {

/// New settings of the head; nullopt: unchanged.
struct DriveHead {
  std::optional<double> range_m = {}, step_deg = {};
  std::optional<ReceiverGain> gain = {};
  /// First and last angle, counter-clockwise from ahead.
  std::optional<std::array<double, 2>> sector_deg = {};
  bool is_full_turn = false;  ///< instead of a sector
};
struct BeginRecording {};
struct EndRecording {};
struct BeginNewMap {};

}  // namespace live_control

using LiveControl = std::variant<live_control::DriveHead, live_control::BeginRecording, live_control::EndRecording,
                                 live_control::BeginNewMap>;

struct LiveViewOptions {
  std::string title = "live";
  MapAxes axes = MapAxes::kUnknown;
  double every_s = 0.25;        ///< from one update to the next, at least
  std::size_t max_streams = 8;  ///< pages that get events; others poll

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// Shows a running LiveMapping on the page. The loop of the run hands over what is new; the rest is done in a thread of
/// this object and those of the server, for which the loop never waits.
class LiveView {
 public:
  /// @param live  runs with KeepChanges::kYes
  /// @param page  has to outlive it, as has `responder`
  /// @return kBadOption when the options do not validate, kUnsupported for maps of less than five levels
  static Result<LiveView> make(const LiveMapping& live, const Page& page, const LiveViewOptions& options = {});
  LiveView(LiveView&&) noexcept;
  LiveView& operator=(LiveView&&) noexcept;
  ~LiveView();

  /// When the next `update` is due, on the clock of the run.
  double due_s() const;
  /// Hands over what is new, where that is due. To be called between two steps, and after `finish`.
  /// @param latency_s  longest recent time from the arrival of a beam until it was mapped
  void update(LiveMapping& live, double latency_s);
  /// Shows a message about the run; the last ones are kept.
  void tell(std::string message);
  /// Commands since the last call, in order.
  std::vector<LiveControl> take_controls();
  /// Waits until all that was handed over is shown.
  void wait_until_shown() const;

  /// Answers requests for the page, what it shows, and its controls, from many threads at once.
  Responder responder() const;

 private:
  class State;
  explicit LiveView(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pingvox::web
