#include "pingvox/web/live_view.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <random>
#include <stop_token>
#include <string_view>
#include <thread>
#include <utility>

#include "base/option_errors.hpp"
#include "base/without_exceptions.hpp"
#include "io/internal/clock.hpp"
#include "io/internal/json.hpp"
#include "web/live_cells.hpp"
#include "web/live_controls.hpp"
#include "web/live_log.hpp"
#include "web/live_news.hpp"
#include "web/live_path.hpp"
#include "web/scene_objects.hpp"
#include "web/take_until.hpp"

namespace pingvox::web {
namespace {

/// As it is, or cpp-httplib would compress it, and hold it back.
constexpr std::string_view kEventStream = "text/event-stream";

}  // namespace

Result<void> LiveViewOptions::validate() const {
  OptionErrors errors;
  constexpr double kLongest_s = 60.0;
  constexpr std::size_t kMaxStreams = 12;  // of the threads of the server
  errors.require_within("every_s", every_s, 0.01, kLongest_s);
  errors.require_within("max_streams", max_streams, std::size_t{0}, kMaxStreams);
  return errors.result("view");
}

class LiveView::State {
 public:
  State(const LiveMapping& live, const Page& page, const LiveViewOptions& options)
      : page_(page),
        options_(options),
        run_(std::random_device()()),
        since_1970_s_(live.since_1970_s()),
        resolution_m_(live.map().lattice().resolution_m()),
        occupancy_(live.map().options().thresholds.upper.probability()),
        moves_(!live.status().nav.empty() || live.status().slam.has_value()),
        head_name_(live.head().name()),
        gatherer_(options.axes),
        log_(live.build(), since_1970_s_),
        cells_(live.map()),
        shows_([this](const std::stop_token& stop) { show(stop); }) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  // Of the loop's thread.

  double due_s() const { return due_s_; }

  void update(LiveMapping& live, double latency_s) {
    gatherer_.note_latency(latency_s);
    const double now_s = live.time_s();
    if (now_s < due_s_) return;
    due_s_ = now_s + options_.every_s;
    {
      // What is not taken stays in the run, or is dropped there.
      const std::lock_guard lock(inbox_mutex_);
      if (inbox_.size() >= kMaxInbox) return;
    }
    const Result<LiveNews> news =
        detail::without_exceptions([&]() -> Result<LiveNews> { return gatherer_.gather(live, now_s, wants_free_); });
    if (!news) {
      // It may be half of them that are lost.
      gatherer_.ask_for_all();
      return;
    }
    const std::lock_guard lock(inbox_mutex_);
    inbox_.push_back(*news);
    ++handed_;
    inbox_changed_.notify_all();
  }

  void tell(std::string message) { gatherer_.tell(std::move(message)); }

  std::vector<LiveControl> take_controls() {
    const std::lock_guard lock(controls_mutex_);
    return std::exchange(controls_, {});
  }

  void wait_until_shown() {
    std::unique_lock lock(content_mutex_);
    content_changed_.wait(lock, [this] {
      const std::lock_guard inbox_lock(inbox_mutex_);
      return shown_ == handed_;
    });
  }

  // Of the server's threads.

  Answer answer(const Request& request, const Access& access) {
    const tl::expected<Asked, Answer> asked = check_request(request, access);
    if (!asked) return asked.error();
    const auto& [method, path, query, may_control] = *asked;
    if (path.starts_with("control/")) return control(*asked);
    if (method != "GET") return answer_of_text(405, "only GET is allowed\n");
    if (std::optional<Answer> part = page_answer(page_, path)) return *std::move(part);
    if (path == "events") return events();
    if (path == "map/0/free") return free_answer();
    const std::lock_guard lock(content_mutex_);
    if (path == "scene.json") return json_answer(scene_json(may_control));
    if (path == "state") return json_answer(text_);
    if (path == "map/0/cells") return answer_of(cells_.all(), kBinaryType);
    if (path == "map/0/changes") {
      const std::optional<std::size_t> since = number_of_query("since", query);
      if (!since) return answer_of_text(400, "since must be a version\n");
      constexpr std::size_t kMaxVersion = 0xFFFFFFFF;
      return answer_of(cells_.since(static_cast<std::uint32_t>(std::min(*since, kMaxVersion))), kBinaryType);
    }
    if (path == "path/0" && moves_) return path_answer(query);
    if (path == "log/0") {
      const std::optional<std::size_t> from = query.empty() ? 0 : number_of_query("from", query);
      if (!from) return answer_of_text(400, "from must be the number of a beam\n");
      return answer_of(log_.beams_from(*from), kBinaryType);
    }
    if (path == "log/0/bins") {
      const std::optional<NumberRange> range = range_of(query);
      std::optional<Bytes> bins = range ? log_.bins_of(range->from, range->to) : std::nullopt;
      if (!bins) return answer_of_text(404, "such beams are not there any more\n");
      return answer_of(*std::move(bins), kBinaryType);
    }
    return not_found();
  }

 private:
  static constexpr std::size_t kMaxInbox = 4;

  /// Takes what is handed over, in a thread of its own.
  void show(const std::stop_token& stop) {
    while (true) {
      std::deque<LiveNews> inbox;
      {
        std::unique_lock lock(inbox_mutex_);
        if (!inbox_changed_.wait(lock, stop, [this] { return !inbox_.empty(); })) return;
        inbox = std::exchange(inbox_, {});
      }
      for (LiveNews& news : inbox) {
        std::optional<Result<Bytes>> free;
        if (news.map) free = free_bytes(*news.map);
        const std::lock_guard lock(content_mutex_);
        if (free) {
          free_ = *std::move(free);
          ++free_version_;
        }
        // Out of memory: the page is not up to date, and mapping goes on.
        static_cast<void>(detail::without_exceptions([&]() -> Result<void> {
          take(std::move(news));
          return {};
        }));
        ++shown_;
        content_changed_.notify_all();
      }
    }
  }

  void take(LiveNews news) {
    cells_.apply(news.cells);
    for (Beam& beam : news.beams) log_.add(std::move(beam));
    if (news.path) {
      for (StampedPose& pose : *news.path) pose.time_s += since_1970_s_;
      path_.replace(*std::move(news.path));
    }
    if (news.pose && moves_) path_.add({since_1970_s_ + news.pose->time_s, news.pose->map_from_body});
    JsonObject json;
    json.add("run", std::uint64_t{run_})
        .add("map",
             JsonObject().add("version", std::uint64_t{cells_.version()}).add("cells", std::uint64_t{cells_.cells()}))
        .add("path", JsonObject()
                         .add("version", std::uint64_t{path_.version()})
                         .add("poses", std::uint64_t{path_.poses().size()}))
        .add("log", JsonObject()
                        .add("first", std::uint64_t{log_.first()})
                        .add("end", std::uint64_t{log_.end()})
                        .add("settled", std::uint64_t{log_.settled()})
                        .add("bins", std::uint64_t{log_.bins()}))
        .add("status", news.status);
    text_ = json.text();
  }

  static Answer json_answer(const std::string& text) { return answer_of(Bytes(text.begin(), text.end()), kJsonType); }

  std::string scene_json(bool may_control) const {
    JsonObject map;
    map.add("id", 0)
        .add("name", "the map")
        .add("format", "live")
        .add("resolution_m", resolution_m_)
        .add("occupancy", occupancy_)
        .add_null("bounds")
        .add("occupied_cells", std::uint64_t{cells_.cells()})
        .add("free_cells", 0)
        .add("cells", "map/0/cells")
        .add("free", "map/0/free")
        .add_null("agreement");
    JsonObject path;
    path.add("id", 0)
        .add("name", "the vehicle")
        .add("poses", std::uint64_t{path_.poses().size()})
        .add("url", "path/0")
        .add("clock", date_text(since_1970_s_).empty() ? "log" : "unix");
    SceneLog log = log_.description(log_.end() - log_.first());
    log.name = head_name_;
    if (moves_) log.path = 0;
    JsonObject live;
    live.add("events", "events").add("state", "state").add("changes", "map/0/changes");
    may_control ? live.add("control", "control/") : live.add_null("control");
    const std::vector<JsonObject> maps = {map}, logs = {log_json(log, 0)}, none;
    const std::vector<JsonObject> paths = moves_ ? std::vector{path} : none;
    return JsonObject()
        .add("title", options_.title)
        .add("version", 1)
        .add("unit", "m")
        .add("axes", axes_json(options_.axes))
        .add("origin_m", Eigen::Vector3d(Eigen::Vector3d::Zero()))
        .add("maps", maps)
        .add("paths", paths)
        .add("points", none)
        .add("logs", logs)
        .add("notes", std::vector<std::string>())
        .add("live", live)
        .text();
  }

  /// Free cells change with each beam and are many: they are made when they are asked for.
  Answer free_answer() {
    constexpr std::size_t kMaxWaiting = 2;  // of the threads of the server
    constexpr std::chrono::seconds kPatience{2};
    std::unique_lock lock(content_mutex_);
    if (free_waiting_ >= kMaxWaiting) return answer_of_text(503, "others ask for free cells; ask again\n");
    ++free_waiting_;
    wants_free_ = true;
    const bool is_made =
        content_changed_.wait_for(lock, kPatience, [this, before = free_version_] { return free_version_ != before; });
    --free_waiting_;
    if (!is_made) return answer_of_text(503, "the map does not change; ask again\n");
    if (!free_) return answer_of_text(503, free_.error().message + "\n");
    return answer_of(*free_, kBinaryType);
  }

  /// "version=3&from=7": poses from there on, where the version is that of the path; else all.
  Answer path_answer(std::string_view query) const {
    const std::vector<StampedPose>& poses = path_.poses();
    std::size_t first = 0;
    if (!query.empty()) {
      const std::optional<std::size_t> version = number_of_query("version", take_until('&', query)),
                                       from = number_of_query("from", query);
      if (!version || !from) return answer_of_text(400, "version and from must be numbers\n");
      if (*version == path_.version()) first = std::min(*from, poses.size());
    }
    return answer_of(pose_bytes(std::span(poses).subspan(first), Eigen::Vector3d::Zero(),
                                {path_.version(), static_cast<std::uint32_t>(first)}),
                     kBinaryType);
  }

  Answer control(const Asked& asked) {
    if (!asked.may_control) return answer_of_text(403, "the address on the terminal can control; this one cannot\n");
    if (asked.method != "POST") return answer_of_text(405, "controls are sent with POST\n");
    std::optional<LiveControl> control = control_of(asked.path, asked.query);
    if (!control) return answer_of_text(400, "unknown command\n");
    constexpr std::size_t kMaxControls = 32;
    const std::lock_guard lock(controls_mutex_);
    if (controls_.size() >= kMaxControls) return answer_of_text(503, "too many commands at once\n");
    controls_.push_back(*control);
    return answer_of_text(202, "");
  }

  /// Counts an answer that goes on, as long as it lives.
  class Stream {
   public:
    explicit Stream(std::atomic<std::size_t>& count) : count_(count) { ++count_; }
    Stream(const Stream&) = delete;
    Stream& operator=(const Stream&) = delete;
    ~Stream() { --count_; }

    std::uint64_t shown = 0;  ///< what was sent last

   private:
    std::atomic<std::size_t>& count_;
  };

  Answer events() {
    auto stream = std::make_shared<Stream>(streams_);
    if (streams_ > options_.max_streams) {
      return answer_of_text(503, "too many pages have an event stream: poll instead\n");
    }
    Answer answer;
    answer.type = kEventStream;
    // A proxy, as that of BlueOS, would keep events until it has many.
    static constexpr std::array kAtOnce = {Header{"X-Accel-Buffering", "no"}};
    answer.headers = kAtOnce;
    answer.next = [this, stream]() -> std::optional<std::string> {
      constexpr std::chrono::milliseconds kPatience{500};
      std::unique_lock lock(content_mutex_);
      content_changed_.wait_for(lock, kPatience, [&] { return shown_ != stream->shown; });
      // A client that has gone is found by what cannot be sent.
      if (shown_ == stream->shown || text_.empty()) return ":\n\n";
      stream->shown = shown_;
      return fmt::format("data: {}\n\n", text_);
    };
    return answer;
  }

  Page page_;
  LiveViewOptions options_;
  std::uint32_t run_;  ///< tells this run from others
  double since_1970_s_, resolution_m_, occupancy_;
  bool moves_;
  std::string head_name_;

  // Of the loop.
  double due_s_ = 0.0;
  NewsGatherer gatherer_;

  std::mutex inbox_mutex_;
  std::condition_variable_any inbox_changed_;
  std::deque<LiveNews> inbox_;
  std::uint64_t handed_ = 0;

  std::mutex content_mutex_;
  std::condition_variable content_changed_;
  LiveLog log_;
  LiveCells cells_;
  LivePath path_;
  std::string text_;  ///< of the last event
  std::uint64_t shown_ = 0;
  Result<Bytes> free_;  ///< free cells of the last map that was handed over
  std::uint64_t free_version_ = 0;
  std::size_t free_waiting_ = 0;

  std::atomic<bool> wants_free_ = false;
  std::mutex controls_mutex_;
  std::vector<LiveControl> controls_;
  std::atomic<std::size_t> streams_ = 0;
  std::jthread shows_;  ///< the last member: it is stopped and joined first
};

Result<LiveView> LiveView::make(const LiveMapping& live, const Page& page, const LiveViewOptions& options) {
  if (const auto valid = options.validate(); !valid) return tl::unexpected(valid.error());
  if (!has_pages(live.map().lattice())) {
    return fail(Error::Code::kUnsupported, "maps of less than five levels are not shown while they grow");
  }
  return detail::without_exceptions([&]() -> Result<LiveView> {
    try {
      return LiveView(std::make_unique<State>(live, page, options));
    } catch (const std::system_error& error) {
      return fail(Error::Code::kIo, fmt::format("no thread for the page: {}", error.what()));
    }
  });
}

LiveView::LiveView(std::unique_ptr<State> state) : state_(std::move(state)) {}
LiveView::LiveView(LiveView&&) noexcept = default;
LiveView& LiveView::operator=(LiveView&&) noexcept = default;
LiveView::~LiveView() = default;

double LiveView::due_s() const {
  return state_->due_s();
}

void LiveView::update(LiveMapping& live, double latency_s) {
  state_->update(live, latency_s);
}

void LiveView::tell(std::string message) {
  state_->tell(std::move(message));
}

std::vector<LiveControl> LiveView::take_controls() {
  return state_->take_controls();
}

void LiveView::wait_until_shown() const {
  state_->wait_until_shown();
}

Responder LiveView::responder() const {
  return
      [state = state_.get()](const Request& request, const Access& access) { return state->answer(request, access); };
}

}  // namespace pingvox::web
