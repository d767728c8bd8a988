// Heads that another program drives: the server of Ping Viewer 2, and the bridge of BlueOS.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "device/internal/link.hpp"
#include "device/internal/live_source.hpp"
#include "device/web_socket.hpp"
#include "io/internal/ping_frame.hpp"
#include "io/internal/ping_json.hpp"
#include "io/internal/ping_viewer_recorder.hpp"
#include "tests/device/recording.hpp"
#include "tests/support/frames.hpp"
#include "tests/support/logs.hpp"
#include "tests/support/mutants.hpp"

namespace pingvox {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using namespace test;

/// A frame of a WebSocket as a server sends it.
std::string server_frame(unsigned first_byte, std::string_view payload) {
  std::string frame(1, static_cast<char>(first_byte));
  if (payload.size() < 126) {
    frame.push_back(static_cast<char>(payload.size()));
  } else {
    frame.push_back(126);
    frame.push_back(static_cast<char>(payload.size() >> 8));
    frame.push_back(static_cast<char>(payload.size() & 0xff));
  }
  return frame.append(payload);
}

std::string text_frame(std::string_view text) {
  return server_frame(0x81, text);
}

// The answer to the key of the example in RFC 6455.
constexpr std::string_view kAgreement =
    "HTTP/1.1 101 Switching Protocols\r\nupgrade: websocket\r\nConnection: Upgrade\r\n"
    "sec-websocket-accept:  s3pPLMBiTxaQ9kYGzzhZRbK+xOo=\r\n\r\n";

std::vector<std::string> texts_of(WebSocket& socket) {
  std::vector<std::string> texts;
  while (auto text = socket.next_text()) texts.push_back(*text);
  return texts;
}

TEST(WebSocket, AsksAsTheProtocolSays) {
  const std::vector<std::uint8_t> request = WebSocket("192.168.2.2:6060", "/ws").request();
  EXPECT_EQ(std::string(request.begin(), request.end()),
            "GET /ws HTTP/1.1\r\nHost: 192.168.2.2:6060\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n");
}

TEST(WebSocket, TextsComeWholeHoweverTheirBytesDo) {
  const std::string longer(3000, 'x');
  const std::string stream = std::string(kAgreement) + text_frame("one") + server_frame(0x01, "t") +
                             server_frame(0x89, "ping") + server_frame(0x00, "w") + server_frame(0x80, "o") +
                             server_frame(0x82, "bytes") + text_frame(longer) + text_frame("");
  for (const std::size_t piece : {std::size_t{1}, std::size_t{7}, stream.size()}) {
    WebSocket socket("h:1", "/ws");
    for (std::size_t at = 0; at < stream.size(); at += piece) {
      socket.take(bytes_of(std::string_view(stream).substr(at, piece)));
    }
    EXPECT_TRUE(socket.is_open());
    EXPECT_EQ(socket.problem(), "");
    EXPECT_THAT(texts_of(socket), ElementsAre("one", "two", longer, ""));
    // A pong with the same bytes, masked.
    ASSERT_TRUE(socket.has_answers());
    const std::vector<std::uint8_t> pong = socket.take_answers();
    ASSERT_THAT(pong, SizeIs(2 + 4 + 4));
    EXPECT_EQ(pong[0], 0x8a);
    EXPECT_EQ(pong[1], 0x84);
    std::string payload;
    for (std::size_t i = 0; i < 4; ++i) payload.push_back(static_cast<char>(pong[6 + i] ^ pong[2 + i]));
    EXPECT_EQ(payload, "ping");
    EXPECT_FALSE(socket.has_answers());
  }
}

// Kills bytes that are taken for a part of a text.
TEST(WebSocket, BytesInPiecesAreNoText) {
  WebSocket socket("h:1", "/ws");
  socket.take(bytes_of(std::string(kAgreement) + text_frame("one") + server_frame(0x02, "by") +
                       server_frame(0x80, "tes") + text_frame("two")));
  EXPECT_THAT(texts_of(socket), ElementsAre("one", "two"));
  EXPECT_TRUE(socket.is_open());
}

TEST(WebSocket, WhatIsNoneEndsItWithAReason) {
  struct Case {
    std::string stream, problem;
  };
  const std::string agreement(kAgreement);
  for (const Case& c :
       {Case{"HTTP/1.1 500 Internal Server Error\r\n\r\n", "answered 'HTTP/1.1 500 Internal Server"},
        Case{"HTTP/1.1 101 Switching\r\nupgrade: websocket\r\n\r\n", "is not a WebSocket"},
        Case{"HTTP/1.1 101 Switching\r\nSec-WebSocket-Accept: abc\r\n\r\n", "is not a WebSocket"},
        Case{std::string(20'000, 'x'), "is not a web server"},
        Case{agreement + server_frame(0x88, "\x03\xe8"), "closed by the server"},
        Case{agreement + server_frame(0xc1, "x"), "sent invalid WebSocket data"},
        Case{agreement + std::string("\x81\x81 1234", 6), "sent invalid WebSocket data"},
        Case{agreement + server_frame(0x83, "x"), "sent invalid WebSocket data"},
        Case{agreement + server_frame(0x09, "x"), "sent invalid WebSocket data"},
        Case{agreement + server_frame(0x8b, "x"), "sent invalid WebSocket data"},
        Case{agreement + std::string("\x81\x7f\xff\xff\xff\xff\xff\xff\xff\xff", 10), "more than a megabyte"}}) {
    WebSocket socket("h:1", "/ws");
    socket.take(bytes_of(c.stream));
    EXPECT_THAT(socket.problem(), HasSubstr(c.problem));
    socket.take(bytes_of(text_frame("x")));
    EXPECT_THAT(texts_of(socket), IsEmpty()) << "nothing is read after the end";
  }
}

/// @param name  AutoDeviceData or DeviceData
std::string ping_text(std::string_view name, unsigned angle_grad, std::string_view data,
                      std::string_view device = "00000000-0000-0000-0000-000000000001") {
  const std::string automatic =
      name == "DeviceData" ? "" : R"("start_angle":150,"stop_angle":250,"num_steps":2,"delay":3,)";
  return fmt::format(
      R"({{"DeviceMessage":{{"PingMessage":{{"Ping360":{{"{}":{{"mode":1,"gain_setting":2,"angle":{},)"
      R"("transmit_duration":32,"sample_period":800,"transmit_frequency":750,{}"number_of_samples":4,"data_length":4,)"
      R"("data":{}}}}}}},"device_id":"{}"}}}})",
      name, angle_grad, automatic, data, device);
}

TEST(PingJson, PingsAreFramesOfTheHead) {
  const auto ping = ping_in_json(ping_text("DeviceData", 300, "[1,2,3,255]"));
  ASSERT_TRUE(ping) << ping.error();
  ASSERT_TRUE(*ping);
  EXPECT_EQ((*ping)->device, "00000000-0000-0000-0000-000000000001");
  // B R, 18 bytes, 2300, from 2 to 0, the fields, the samples and the sum.
  EXPECT_EQ((*ping)->frame, from_hex("4252 1200 fc08 0200 01 02 2c01 2000 2003 ee02 0400 0400 010203ff 1c04"));
  const auto automatic = ping_in_json(ping_text("AutoDeviceData", 300, "[1,2]"));
  ASSERT_TRUE(automatic && *automatic);
  EXPECT_EQ(ping_message((*automatic)->frame), PingMessage::kAutoDeviceData);
  const auto beam = ping_beam_in((*automatic)->frame, 5.0);
  ASSERT_TRUE(beam && *beam) << "with fewer samples than were asked for";
  EXPECT_THAT((*beam)->intensities, ElementsAre(1, 2));
  EXPECT_NEAR((*beam)->bearing_rad, 1.5 * std::numbers::pi, 1e-12);
}

TEST(PingJson, OtherMessagesAreNoneAndBrokenOnesHaveAReason) {
  for (const char* text :
       {R"({"DeviceInfo":[{"id":"1","device_type":"Ping360"}]})", R"({"DeviceError":"x"})", "{}",
        R"({"DeviceMessage":{"PingMessage":{"Ping1D":{"Profile":{"distance":1}}},"device_id":"1"}})"}) {
    const auto ping = ping_in_json(text);
    ASSERT_TRUE(ping) << text;
    EXPECT_FALSE(*ping) << text;
  }
  EXPECT_THAT(ping_in_json("{").error(), HasSubstr("no JSON"));
  EXPECT_THAT(ping_in_json(ping_text("DeviceData", 70'000, "[1,2]")).error(), HasSubstr("without its angle"));
  EXPECT_THAT(ping_in_json(ping_text("DeviceData", 7, "[1,256]")).error(), HasSubstr("8 bits"));
  EXPECT_THAT(ping_in_json(ping_text("DeviceData", 7, "\"AQI=\"")).error(), HasSubstr("8 bits"));
}

// What a stranger at the port sends.
TEST(PingViewer2Live, NoBytesOfAServerAreTrusted) {
  const std::string stream = std::string(kAgreement) + text_frame(ping_text("DeviceData", 200, "[0,9,8,7]")) +
                             server_frame(0x89, "ping") + text_frame(ping_text("AutoDeviceData", 201, "[1,2,3,4]"));
  const std::vector<std::uint8_t> seed = bytes_of(stream);
  std::size_t pings = 0, refused = 0;
  for (unsigned i = 0; i < 3000; ++i) {
    std::mt19937_64 random(i);
    WebSocket socket("h:1", "/ws");
    socket.take(mutant(seed, seed, random));
    while (const auto text = socket.next_text()) {
      const auto ping = ping_in_json(*text);
      if (!ping) ++refused;
      if (!ping || !*ping) continue;
      ++pings;
      EXPECT_EQ(frames_in(check_ping_frame, (*ping)->frame, 4096), Frames{(*ping)->frame});
    }
  }
  EXPECT_GT(pings, 1000U);
  EXPECT_GT(refused, 100U);
}

/// The server of Ping Viewer 2, at one end of a line.
class Server {
 public:
  Server() : line_(*Link::listen("tcp://127.0.0.1:0")) {}

  const std::string& address() const { return line_.address(); }
  const std::string& heard() const { return heard_; }
  void send(std::string_view bytes) { ASSERT_TRUE(line_.write(bytes_of(bytes))); }

  /// Reads what came. The request is answered.
  void step(std::string_view answer = kAgreement) {
    std::array<std::uint8_t, 4096> bytes;
    const Result<std::size_t> got = line_.read(bytes);
    if (!got) return;
    heard_.append(reinterpret_cast<const char*>(bytes.data()), *got);
    if (has_answered_ || heard_.find("\r\n\r\n") == std::string::npos) return;
    has_answered_ = true;
    send(answer);
  }
  bool has_answered() const { return has_answered_; }

 private:
  Link line_;
  std::string heard_;
  bool has_answered_ = false;
};

/// Lets source and server talk, in virtual time, until `is_enough`, for a second at most.
template <class Enough>
void talk(LiveSource& source, Server& server, double& now_s, std::vector<Beam>& beams, Enough is_enough,
          std::string_view answer = kAgreement) {
  for (int i = 0; i < 1000 && !is_enough(); ++i) {
    ASSERT_TRUE(source.step(now_s, beams));
    server.step(answer);
    now_s += 1e-3;
    pollfd end = {source.descriptor(), POLLIN, 0};
    ::poll(&end, 1, 1);
  }
  ASSERT_TRUE(is_enough());
}

TEST(PingViewer2Live, PingsAreBeamsAndTheirRecordingGivesTheSame) {
  const Folder folder;
  Result<PingViewerRecorder> recorder = PingViewerRecorder::create(folder.path("dive.bin"));
  ASSERT_TRUE(recorder);
  Server server;
  const auto source = ping_viewer_2_source(server.address(), "", std::move(*recorder), 0.0);
  double now_s = 0.0;
  std::vector<Beam> beams;
  talk(*source, server, now_s, beams, [&] { return server.has_answered(); });
  EXPECT_THAT(server.heard(), HasSubstr("GET /ws HTTP/1.1\r\n"));
  EXPECT_FALSE(source->status().is_connected) << "no ping came";
  server.send(text_frame(R"({"DeviceInfo":[]})") + text_frame(ping_text("DeviceData", 200, "[0,9,8,7]")));
  server.send(text_frame(ping_text("AutoDeviceData", 201, "[1,2,3,4]")));
  server.send(text_frame(ping_text("DeviceData", 100, "[5,5,5,5]", "00000000-0000-0000-0000-000000000002")));
  server.send(text_frame(ping_text("DeviceData", 202, "[300]")) +
              text_frame(ping_text("DeviceData", 202, "[4,3,2,1]")));
  talk(*source, server, now_s, beams, [&] { return beams.size() == 3; });
  EXPECT_EQ(beams[0].bearing_rad, 0.0);
  EXPECT_THAT(beams[2].intensities, ElementsAre(4, 3, 2, 1));
  const HeadStatus status = source->status();
  EXPECT_TRUE(status.is_connected);
  EXPECT_EQ(status.connections, 1U);
  EXPECT_EQ(status.unexpected, 2U) << "of another device, and without samples";
  EXPECT_THAT(status.first_unexpected, HasSubstr("a ping of device 00000000-0000-0000-0000-000000000002"));
  const std::size_t heard = server.heard().size();
  source->finish(beams);
  talk(*source, server, now_s, beams, [&] { return true; });
  server.step();
  EXPECT_EQ(server.heard().size(), heard) << "any text would be a command";
  expect_equal(beams_in(folder.path("dive.bin")), beams);
}

TEST(PingViewer2Live, ADeviceIsAskedForAndARefusalIsNamed) {
  Server server;
  const auto source = ping_viewer_2_source(server.address(), "ab-12", std::nullopt, 0.0);
  double now_s = 0.0;
  std::vector<Beam> beams;
  talk(
      *source, server, now_s, beams, [&] { return !source->status().problem.empty(); },
      "HTTP/1.1 500 Internal Server Error\r\n\r\n");
  EXPECT_THAT(server.heard(), HasSubstr("GET /ws?device_number=ab-12 HTTP/1.1\r\n"));
  EXPECT_THAT(source->status().problem, HasSubstr("answered 'HTTP/1.1 500 Internal Server Error'"));
}

TEST(PingViewer2Live, WithoutPingsTheConnectionIsMadeAnewAndSaysWhy) {
  Server server;
  const auto source = ping_viewer_2_source(server.address(), "", std::nullopt, 0.0);
  double now_s = 0.0;
  std::vector<Beam> beams;
  talk(*source, server, now_s, beams, [&] { return server.has_answered(); });
  for (int i = 0; i < 20; ++i) {
    server.send(server.has_answered() && i == 0 ? server_frame(0x89, "") : "");
    talk(*source, server, now_s, beams, [&] { return true; });
    ASSERT_TRUE(source->step(now_s, beams));
    server.step();
  }
  EXPECT_EQ(source->status().problem, "");
  ASSERT_TRUE(source->step(now_s += 10.5, beams));
  EXPECT_THAT(source->status().problem, HasSubstr("no pings: is the sonar started in Ping Viewer?"));
}

/// Reads all datagrams that came.
std::vector<std::uint8_t> datagrams(Link& line) {
  std::vector<std::uint8_t> all;
  std::array<std::uint8_t, 4096> bytes;
  for (int i = 0; i < 20; ++i) {
    const Result<std::size_t> got = line.read(bytes);
    if (got) all.insert(all.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(*got));
    pollfd end = {line.descriptor(), POLLIN, 0};
    if (::poll(&end, 1, 1) <= 0 && i > 3) break;
  }
  return all;
}

// Kills a second host at the bridge that commands the head, too, and stops it at the end.
TEST(SharedPing360, IsHeardAndNothingIsSentThatCommandsIt) {
  const std::vector<std::uint8_t> request = from_hex("42520200 0600 0000 0500 a100");
  const Folder folder;
  Result<PingViewerRecorder> recorder = PingViewerRecorder::create(folder.path("dive.bin"));
  ASSERT_TRUE(recorder);
  Result<Link> bridge = Link::listen("udp://127.0.0.1:0");
  ASSERT_TRUE(bridge);
  const auto source = shared_ping360_source(bridge->address(), std::move(*recorder), 0.0);
  double now_s = 0.0;
  std::vector<Beam> beams;
  ASSERT_TRUE(source->step(now_s, beams));
  EXPECT_EQ(datagrams(*bridge), request);
  // Pieces of the line, that other host's dialogue.
  std::vector<std::uint8_t> line = ping_in_json(ping_text("DeviceData", 200, "[0,9,8,7]")).value()->frame;
  const auto second = ping_in_json(ping_text("AutoDeviceData", 300, "[1,2,3,4]")).value()->frame;
  line.insert(line.end(), second.begin(), second.end());
  for (std::size_t at = 0; at < line.size(); at += 11) {
    const std::span<const std::uint8_t> rest = std::span<const std::uint8_t>(line).subspan(at);
    ASSERT_TRUE(bridge->write(rest.first(std::min<std::size_t>(11, rest.size()))));
    pollfd end = {source->descriptor(), POLLIN, 0};
    ::poll(&end, 1, 100);
    ASSERT_TRUE(source->step(now_s += 0.01, beams));
  }
  ASSERT_THAT(beams, SizeIs(2));
  EXPECT_TRUE(source->status().is_connected);
  ASSERT_TRUE(source->step(now_s += 9.0, beams));
  EXPECT_THAT(datagrams(*bridge), IsEmpty());
  EXPECT_TRUE(source->status().is_connected);
  ASSERT_TRUE(source->step(now_s += 2.0, beams));
  EXPECT_EQ(datagrams(*bridge), request) << "the bridge may have restarted";
  EXPECT_FALSE(source->status().is_connected);
  EXPECT_THAT(source->status().problem, HasSubstr("no pings"));
  source->finish(beams);
  EXPECT_THAT(datagrams(*bridge), IsEmpty()) << "the motor goes on";
  expect_equal(beams_in(folder.path("dive.bin")), beams);
}

}  // namespace
}  // namespace pingvox
