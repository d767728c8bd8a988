#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <future>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "device/recording.hpp"
#include "io/internal/descriptor.hpp"
#include "live/dive.hpp"
#include "pingvox/web/live_view.hpp"
#include "pingvox/web/page.hpp"
#include "pingvox/web/scene_bytes.hpp"
#include "pingvox/web/server.hpp"
#include "web/following_client.hpp"

// A run that is looked at while it goes on.
namespace pingvox::web {
namespace {

using test::Dive;
using test::FollowingClient;
using testing::HasSubstr;

const Page kLivePage{"<html>", "script", "style"};
const Access kLiveAccess{.port = 80, .hosts = {"localhost"}, .token = "secret", .is_open = true};

LiveOptions watched() {
  LiveOptions options;
  options.changes = KeepChanges::kYes;
  return options;
}

/// A dive that is shown on a page.
class ShownDive {
 public:
  explicit ShownDive(LiveOptions options = watched(), LiveViewOptions of_view = {.every_s = 0.05})
      : dive_(std::move(options)), view_(LiveView::make(dive_.live(), kLivePage, of_view)) {
    EXPECT_TRUE(view_) << view_.error().message;
  }

  LiveMapping& live() { return dive_.live(); }
  LiveView& view() { return *view_; }

  /// Runs for a while, and shows what has come.
  void run_for(double seconds) {
    for (const double end_s = dive_.now_s() + seconds; dive_.now_s() < end_s;) step();
    // With room for it, the last of all is shown.
    view_->wait_until_shown();
    step();
    view_->wait_until_shown();
  }

  Answer ask(const std::string& target, const std::string& method = "GET") const {
    return view_->responder()({.method = method, .target = target, .host = "localhost"}, kLiveAccess);
  }
  std::string text_of(const std::string& target) const {
    const Answer answer = ask(target);
    EXPECT_EQ(answer.status, 200) << target;
    return {answer.body.begin(), answer.body.end()};
  }
  void follow(FollowingClient& client) const {
    client.take(ask("/map/0/changes?since=" + std::to_string(client.version())).body);
  }

  /// A tenth of a second.
  void step() {
    dive_.run_for(0.1);
    view_->update(live(), 0.001);
  }

 private:
  Dive dive_;
  Result<LiveView> view_;
};

TEST(LiveView, ClientThatFollowsHasTheFinalMap) {
  ShownDive dive;
  FollowingClient client, late;
  for (int i = 0; i < 4; ++i) {
    dive.run_for(1.0);
    dive.follow(client);
  }
  EXPECT_FALSE(client.cells().empty());
  dive.follow(late);
  const auto wanted = test::read_cells(*cells_bytes(dive.live().map())).probability;
  EXPECT_EQ(client.cells(), wanted);
  EXPECT_EQ(late.cells(), wanted);
}

TEST(LiveView, TellsSceneStateAndBeams) {
  ShownDive dive;
  dive.run_for(2.0);
  const std::string scene = dive.text_of("/secret/scene.json");
  EXPECT_THAT(scene, HasSubstr(R"("control": "control/")"));
  EXPECT_THAT(dive.text_of("/scene.json"), HasSubstr(R"("control": null)"));
  const std::string state = dive.text_of("/state");
  EXPECT_THAT(state, HasSubstr(R"("connected": true)"));
  EXPECT_THAT(state, HasSubstr(R"("recording": false)"));
  EXPECT_THAT(state, HasSubstr(R"("obstacles_m": [)"));

  const Answer beams_of_log = dive.ask("/log/0?from=3");
  test::NumberReader log(beams_of_log.body);
  EXPECT_EQ(log.take<std::uint32_t>(), 0x4c585650U);
  const auto beams = log.take<std::uint32_t>(), bins = log.take<std::uint32_t>();
  EXPECT_EQ(log.take<std::uint32_t>(), 3U);
  EXPECT_EQ(beams + 3, dive.live().beams());
  EXPECT_EQ(dive.ask("/log/0/bins?from=3&to=5").body.size(), 2 * bins);
  EXPECT_EQ(dive.ask("/log/0/bins?from=3&to=100000").status, 404);
  EXPECT_EQ(dive.ask("/map/0/changes?since=x").status, 400);
  EXPECT_EQ(dive.ask("/map/0/changes").status, 400);
  EXPECT_EQ(dive.ask("/path/0").status, 404) << "it stands still";
  EXPECT_EQ(dive.ask("/log/1").status, 404);
  EXPECT_EQ(dive.ask("/").body.size(), kLivePage.html.size());
}

TEST(LiveView, FreeCellsComeWhenTheyAreAskedFor) {
  ShownDive dive;
  dive.run_for(2.0);
  EXPECT_THAT(dive.text_of("/scene.json"), HasSubstr(R"("free": "map/0/free")"));
  // Twice: the second answer has what was mapped since the first one.
  for (int i = 0; i < 2; ++i) {
    std::future<Answer> asked = std::async(std::launch::async, [&] { return dive.ask("/map/0/free"); });
    std::vector<Bytes> maps;  // a copy of one of them is handed over
    while (asked.wait_for(std::chrono::milliseconds(0)) != std::future_status::ready) {
      dive.step();
      maps.push_back(*free_bytes(dive.live().map()));
    }
    const Answer answer = asked.get();
    ASSERT_EQ(answer.status, 200);
    EXPECT_GT(answer.body.size(), 1000U);
    EXPECT_THAT(maps, testing::Contains(Bytes(answer.body.begin(), answer.body.end()))) << i;
    dive.run_for(2.0);
  }
}

TEST(LiveView, FreeCellsOfARunThatStandsStillAreNotAwaitedForEver) {
  ShownDive dive;
  dive.run_for(0.5);
  EXPECT_EQ(dive.ask("/map/0/free").status, 503);
}

TEST(LiveView, TakesControlsWithTheTokenAlone) {
  ShownDive dive;
  const std::string head = "/control/head?range=3&gain=high&step=1.8&sector=-60,60";
  EXPECT_EQ(dive.ask(head, "POST").status, 403);
  EXPECT_EQ(dive.ask("/wrong" + head, "POST").status, 405);
  EXPECT_EQ(dive.ask("/secret" + head).status, 405);
  const Answer foreign = dive.view().responder()(
      {.method = "POST", .target = "/secret" + head, .host = "localhost", .origin = "http://evil"}, kLiveAccess);
  EXPECT_EQ(foreign.status, 403);
  for (const char* const bad : {"head", "head?range=", "head?range=1x", "head?gain=huge", "head?sector=1", "head?x=1",
                                "recording/begin?now=1", "map", "../map/new"}) {
    EXPECT_EQ(dive.ask(std::string("/secret/control/") + bad, "POST").status, 400) << bad;
  }
  EXPECT_TRUE(dive.view().take_controls().empty());

  EXPECT_EQ(dive.ask("/secret" + head, "POST").status, 202);
  EXPECT_EQ(dive.ask("/secret/control/recording/begin", "POST").status, 202);
  EXPECT_EQ(dive.ask("/secret/control/recording/end", "POST").status, 202);
  EXPECT_EQ(dive.ask("/secret/control/map/new", "POST").status, 202);
  const std::vector<LiveControl> controls = dive.view().take_controls();
  ASSERT_EQ(controls.size(), 4U);
  const auto* const drive = std::get_if<live_control::DriveHead>(&controls[0]);
  ASSERT_NE(drive, nullptr);
  EXPECT_EQ(drive->range_m, 3.0);
  EXPECT_EQ(drive->gain, ReceiverGain::kHigh);
  EXPECT_EQ(drive->step_deg, 1.8);
  EXPECT_EQ(drive->sector_deg, (std::array{-60.0, 60.0}));
  EXPECT_TRUE(std::holds_alternative<live_control::BeginNewMap>(controls[3]));
  std::size_t taken = 0;
  while (dive.ask("/secret/control/map/new", "POST").status == 202 && taken < 1000) ++taken;
  EXPECT_LT(taken, 100U) << "requests are not kept without limit";
}

TEST(LiveView, StreamsAreLimitedAndGoWithTheirClients) {
  ShownDive dive(watched(), {.every_s = 0.05, .max_streams = 2});
  dive.run_for(0.5);
  {
    const Answer first = dive.ask("/events");
    const Answer second = dive.ask("/events");
    EXPECT_EQ(second.status, 200);
    EXPECT_EQ(dive.ask("/events").status, 503);
    EXPECT_THAT(first.next().value_or(""), HasSubstr("data: {"));
    EXPECT_EQ(first.next(), ":\n\n") << "nothing is new";
    dive.run_for(0.2);
    EXPECT_THAT(first.next().value_or(""), HasSubstr("data: {"));
  }
  EXPECT_EQ(dive.ask("/events").status, 200);
}

TEST(LiveView, NewMapHeadAndRecordingAreShown) {
  const test::Folder folder;
  LiveOptions options = watched();
  options.record = folder.path("records");
  ShownDive dive(options);
  FollowingClient client;
  dive.run_for(2.0);
  dive.follow(client);
  EXPECT_FALSE(client.cells().empty());
  EXPECT_THAT(dive.text_of("/state"), HasSubstr(R"("recording": true)"));

  LiveHead head = dive.live().head();
  head.ping360.range_m = 3.0;
  head.ping360.gain = ReceiverGain::kHigh;
  ASSERT_TRUE(dive.live().drive(head));
  dive.run_for(0.2);  // a change of range ends a sweep
  dive.live().end_recording();
  const std::size_t beams = dive.live().beams();
  const Result<OccupancyMap> before = dive.live().begin_new_map();
  ASSERT_TRUE(before);
  EXPECT_FALSE(before->empty());
  EXPECT_TRUE(dive.live().map().empty());
  EXPECT_EQ(dive.live().beams(), beams);
  dive.run_for(0.06);
  dive.follow(client);
  EXPECT_TRUE(client.cells().empty());
  EXPECT_THAT(dive.text_of("/state"), HasSubstr(R"("recording": false)"));
  EXPECT_THAT(dive.text_of("/state"), HasSubstr(R"("gain": "high")"));

  ASSERT_TRUE(dive.live().begin_recording());
  const std::size_t recorded_from = dive.live().beams();
  dive.run_for(2.0);
  EXPECT_EQ(dive.live().status().head.unexpected, 0U) << "none is asked for with the one and heard with the other";
  ASSERT_TRUE(dive.live().finish());
  EXPECT_EQ(dive.live().recordings().size(), 2U);
  const std::vector<Beam> recorded = test::beams_in(dive.live().recordings().back().string());
  EXPECT_GE(recorded.size() + 1, dive.live().beams() - recorded_from) << "but for one that was on its way";
  ASSERT_FALSE(recorded.empty());
  const Beam& last = recorded.back();
  EXPECT_NEAR(static_cast<double>(last.intensities.size()) * last.bin_length_m, 3.0, 0.05);
}

#define PINGVOX_NEEDS_SERVER() \
  if (!built_in_page()) GTEST_SKIP() << "built without the server"

/// A connection on which a request was sent, and nothing is read.
Descriptor ask_and_wait(const Server& server, const std::string& target) {
  const std::string& url = server.url();
  const std::size_t colon = url.find(':', 7);
  const int port = std::stoi(url.substr(colon + 1));
  Descriptor socket(::socket(AF_INET, SOCK_STREAM, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const auto* const any = reinterpret_cast<const sockaddr*>(&address);
  EXPECT_EQ(::connect(socket.get(), any, sizeof address), 0);
  const std::string text = "GET " + target + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) + "\r\n\r\n";
  EXPECT_EQ(::send(socket.get(), text.data(), text.size(), MSG_NOSIGNAL), static_cast<ssize_t>(text.size()));
  return socket;
}

std::string read_until(const Descriptor& socket, const std::string& wanted) {
  std::string all;
  std::array<char, 4096> buffer{};
  while (all.find(wanted) == std::string::npos) {
    const ssize_t got = ::recv(socket.get(), buffer.data(), buffer.size(), 0);
    if (got <= 0) break;
    all.append(buffer.data(), static_cast<std::size_t>(got));
  }
  return all;
}

TEST(LiveView, ClientsThatNeverReadHoldNothingUp) {
  PINGVOX_NEEDS_SERVER();
  ShownDive dive(watched(), {.every_s = 0.01, .max_streams = 4});
  const Result<Server> server = Server::start(dive.view().responder(), {.token = WantToken::kForControl});
  ASSERT_TRUE(server) << server.error().message;
  std::vector<Descriptor> deaf;
  for (int i = 0; i < 3; ++i) deaf.push_back(ask_and_wait(*server, "/events"));
  const Descriptor reader = ask_and_wait(*server, "/events");
  // The run is in virtual time: if it waited for anybody, it would not end.
  dive.run_for(3.0);
  EXPECT_GT(dive.live().report().beams, 50U);
  EXPECT_THAT(read_until(reader, "\"mapped\""), HasSubstr("text/event-stream"));
  EXPECT_THAT(read_until(ask_and_wait(*server, "/state"), "}}"), HasSubstr("\"run\""));
  // Those who have gone are noticed when there is something to tell, and others get their places.
  deaf.clear();
  std::string answer;
  for (int i = 0; i < 200 && answer.find("200") == std::string::npos; ++i) {
    dive.run_for(0.05);
    const Descriptor next = ask_and_wait(*server, "/events");
    answer = read_until(next, "\r\n").substr(0, 15);
    if (answer.find("503") != std::string::npos) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  EXPECT_THAT(answer, HasSubstr("200"));
}

TEST(LiveView, AddressAtLoopbackHasATokenForControls) {
  PINGVOX_NEEDS_SERVER();
  ShownDive dive;
  const Result<Server> server = Server::start(dive.view().responder(), {.token = WantToken::kForControl});
  ASSERT_TRUE(server) << server.error().message;
  const std::string& url = server->url();
  const std::string token = url.substr(url.find('/', 8));
  EXPECT_EQ(token.size(), 34U) << token;
  EXPECT_THAT(read_until(ask_and_wait(*server, token + "scene.json"), "}}"), HasSubstr(R"("control": "control/")"));
  EXPECT_THAT(read_until(ask_and_wait(*server, "/scene.json"), "}}"), HasSubstr(R"("control": null)"));
}

}  // namespace
}  // namespace pingvox::web
