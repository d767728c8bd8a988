#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <csignal>
#include <string>

#include "call.hpp"
#include "io/internal/descriptor.hpp"
#include "live_head.hpp"

// `pingvox view` as people call it. Without the page it says how to add it.
namespace pingvox::test {
namespace {

/// Whether the program that is tested was built with the page.
bool has_page(const Workplace& place) {
  place.write("path.tum", "0 0 0 0 0 0 0 1\n");
  const Outcome outcome = place.call({"view", "path.tum", "--export", "probe.html"});
  if (outcome.status == 0) return true;
  expect_error(outcome, 1, {"no page", "tools/packages view"});
  return false;
}

#define PINGVOX_NEEDS_PAGE(place) \
  if (!has_page(place)) GTEST_SKIP() << "built without the page"

/// What a server says to a GET.
std::string answer_of(const std::string& url, const std::string& target) {
  const int port = std::stoi(url.substr(url.rfind(':') + 1));
  const Descriptor client(::socket(AF_INET, SOCK_STREAM, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const auto* const any = reinterpret_cast<const sockaddr*>(&address);
  if (::connect(client.get(), any, sizeof address) != 0) return "no connection";
  const std::string request =
      "GET " + target + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) + "\r\nConnection: close\r\n\r\n";
  ::send(client.get(), request.data(), request.size(), MSG_NOSIGNAL);
  std::string all;
  std::array<char, 4096> buffer{};
  for (;;) {
    const ssize_t got = ::recv(client.get(), buffer.data(), buffer.size(), 0);
    if (got <= 0) return all;
    all.append(buffer.data(), static_cast<std::size_t>(got));
  }
}

TEST(View, judgesTheCellsOfALogOnRequest) {
  const Workplace place;
  PINGVOX_NEEDS_PAGE(place);
  place.simulate_tank();
  const std::string agreement = "id=\"map/0/agreement\"";
  EXPECT_EQ(place.call({"view", "tank.csv", "--export", "plain.html"}).status, 0);
  EXPECT_EQ(place.read("plain.html").find(agreement), std::string::npos);
  const Outcome outcome = place.call({"view", "tank.csv", "--agreement", "--export", "page.html"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("% of the echoes"), std::string::npos) << outcome.err;
  EXPECT_NE(place.read("page.html").find(agreement), std::string::npos);
}

TEST(View, writesALogWithItsMapIntoOnePage) {
  const Workplace place;
  PINGVOX_NEEDS_PAGE(place);
  place.simulate_tank();
  const Outcome outcome = place.call({"view", "tank.csv", "--export", "page.html"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("page.html: a page for any browser, "), std::string::npos) << outcome.out;
  const std::string page = place.read("page.html");
  for (const char* url : {"scene.json", "map/0/cells", "map/0/free", "log/0", "log/0/bins"}) {
    EXPECT_NE(page.find("id=\"" + std::string(url) + "\""), std::string::npos) << url;
  }
  EXPECT_LT(page.size(), 1'500'000U);
}

TEST(View, servesAtTheAddressOfItsFirstLineUntilASignal) {
  const Workplace place;
  PINGVOX_NEEDS_PAGE(place);
  place.simulate_tank();
  ASSERT_EQ(place.call({"map", "tank.csv", "-o", "tank.bt"}).status, 0);
  const pid_t child = place.start({"view", "tank.bt", "path.tum", "tank.csv", "--no-open"},
                                  {.out_path = place.path("out.txt"), .err_path = place.path("err.txt")});
  ASSERT_TRUE(wait_until([&] { return place.has("out.txt") && place.read("out.txt").ends_with("/\n"); }));
  const std::string url = place.read("out.txt");
  EXPECT_TRUE(url.starts_with("http://127.0.0.1:")) << url;
  const std::string scene = answer_of(url, "/scene.json");
  EXPECT_TRUE(scene.starts_with("HTTP/1.1 200")) << scene;
  for (const char* part :
       {"\"tank.bt and 2 others\"", "\"format\": \"bt\"", "\"tank.csv\"", "\"beam_width_deg\": 3,"}) {
    EXPECT_NE(scene.find(part), std::string::npos) << part << " in " << scene;
  }
  EXPECT_EQ(scene.find("the map of"), std::string::npos) << "a log is not mapped where there is a map";
  EXPECT_TRUE(answer_of(url, "/map/0/cells").starts_with("HTTP/1.1 200"));
  ::kill(child, SIGTERM);
  EXPECT_EQ(status_in_time(child), 0) << place.read("err.txt");
}

TEST(View, mapsALogAsMapDoes) {
  const Workplace place;
  PINGVOX_NEEDS_PAGE(place);
  place.simulate_tank();
  const std::vector<std::string> options = {"--resolution", "0.1", "--threshold", "60"};
  std::vector<std::string> map = {"map", "tank.csv", "-o", "tank.pvx"},
                           log = {"view", "tank.csv", "--export", "a.html"};
  map.insert(map.end(), options.begin(), options.end());
  log.insert(log.end(), options.begin(), options.end());
  ASSERT_EQ(place.call(map).status, 0);
  ASSERT_EQ(place.call(log).status, 0);
  ASSERT_EQ(place.call({"view", "tank.pvx", "--export", "b.html"}).status, 0);
  const auto cells = [&](const std::string& name) {
    const std::string page = place.read(name);
    const std::size_t at = page.find("id=\"map/0/cells\">");
    return page.substr(at, page.find('<', at) - at);
  };
  EXPECT_GT(cells("a.html").size(), 1000U);
  EXPECT_EQ(cells("a.html"), cells("b.html"));
}

TEST(View, refusesWhatHasNoEffect) {
  const Workplace place;
  place.write("path.tum", "0 0 0 0 0 0 0 1\n");
  expect_error(place.call({"view", "path.tum", "--export", "page.html", "--port", "8080"}), 2, {"--export", "--port"});
  expect_error(place.call({"view", "path.tum", "--export", "path.tum"}), 2, {"--export", "path.tum"});
  expect_error(place.call({"view"}), 2, {"FILE"});
  expect_error(place.call({"view", "path.tum", "--port", "70000"}), 2, {"--port", "65535"});
  PINGVOX_NEEDS_PAGE(place);
  expect_error(place.call({"view", "path.tum", "--export", "page.html", "--resolution", "0.1"}), 2, {"--resolution"});
  expect_error(place.call({"view", "path.tum", "--export", "page.html", "--agreement"}), 2, {"--agreement"});
  expect_error(place.call({"view", "missing.bt", "--export", "page.html"}), 1, {"missing.bt"});
  place.write("text.txt", "hello\n");
  expect_error(place.call({"view", "text.txt", "--export", "page.html"}), 1, {"text.txt"});
  EXPECT_FALSE(place.has("page.html"));
}

}  // namespace
}  // namespace pingvox::test
