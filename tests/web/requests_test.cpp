#include "fuzz/bodies/requests.hpp"

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "pingvox/io/file.hpp"
#include "support/mutants.hpp"
#include "web/blueos.hpp"
#include "web/live_controls.hpp"

// What a server answers, without a socket.
namespace pingvox::web {
namespace {

const Page kPage{"<html>", "script", "style"};

Access local() {
  return {.port = 8080, .hosts = {"localhost", "127.0.0.1", "[::1]"}};
}

Answer answer_to(const Request& request, const Access& access = local()) {
  return Answers(fuzz::small_scene(), kPage).answer(request, access);
}

Request get(std::string target) {
  return {.method = "GET", .target = std::move(target), .host = "localhost:8080"};
}

std::string text_of(const Answer& answer) {
  return {answer.body.begin(), answer.body.end()};
}

TEST(Requests, ofThePageAreAnsweredWithItsParts) {
  EXPECT_EQ(text_of(answer_to(get("/"))), "<html>");
  EXPECT_EQ(answer_to(get("/")).type, "text/html; charset=utf-8");
  EXPECT_EQ(text_of(answer_to(get("/page.js"))), "script");
  EXPECT_EQ(text_of(answer_to(get("/page.css"))), "style");
  EXPECT_EQ(answer_to(get("/favicon.ico")).status, 204);
  EXPECT_NE(text_of(answer_to(get("/scene.json"))).find("\"fuzzed\""), std::string::npos);
}

TEST(Requests, ofTheSceneAreAnsweredWithItsBytes) {
  const Scene scene = fuzz::small_scene();
  const auto bytes = [](const Answer& answer) { return Bytes(answer.body.begin(), answer.body.end()); };
  EXPECT_EQ(bytes(answer_to(get("/map/0/cells"))), cells_bytes(scene.maps[0].map));
  EXPECT_EQ(bytes(answer_to(get("/map/0/free"))), free_bytes(scene.maps[0].map));
  EXPECT_EQ(bytes(answer_to(get("/path/0"))), path_bytes(scene.paths[0], scene.origin_m()));
  EXPECT_EQ(bytes(answer_to(get("/points/0"))), points_bytes(scene.points[0], scene.origin_m()));
  EXPECT_EQ(bytes(answer_to(get("/log/0"))), beams_bytes(scene.logs[0]));
}

TEST(Requests, ofBeamsGetThoseThatTheyName) {
  // The answer lies in the scene, so the scene has to live as long.
  const Answers answers(fuzz::small_scene(), kPage);
  const auto bins = [&](const std::string& query) {
    const Answer answer = answers.answer(get("/log/0/bins" + query), local());
    return std::pair(answer.status, std::vector<int>(answer.body.begin(), answer.body.end()));
  };
  using Bins = std::pair<int, std::vector<int>>;
  EXPECT_EQ(bins(""), (Bins{200, {1, 2, 3, 4, 5, 6}}));
  EXPECT_EQ(bins("?from=1&to=2"), (Bins{200, {4, 5, 6}}));
  EXPECT_EQ(bins("?from=2&to=2"), (Bins{200, {}}));
  for (const char* query : {"?from=1&to=3", "?from=2&to=1", "?to=1&from=0", "?from=-1&to=1", "?from=0", "?from=&to=",
                            "?x", "?from=0&to=18446744073709551617", "?from=0&to=1&to=2", "?from=+0&to=1"}) {
    EXPECT_EQ(bins(query).first, 400) << query;
  }
}

TEST(Requests, ofAnythingElseFindNothing) {
  for (const char* target : {"",
                             "/..",
                             "/../page.js",
                             "/page.js/",
                             "/page.html",
                             "//",
                             "/map/1/cells",
                             "/map/0",
                             "/map//cells",
                             "/map/00/cells",
                             "/map/+0/cells",
                             "/map/0/cells/",
                             "/map/0/agreement",
                             "/path/1",
                             "/path/-1",
                             "/points/7",
                             "/log/1",
                             "/log/0/bins/",
                             "/log/9/bins",
                             "/%70age.js",
                             "/etc/passwd",
                             "page.js",
                             "http://localhost:8080/"}) {
    EXPECT_EQ(answer_to(get(target)).status, 404) << target;
  }
  EXPECT_EQ(answer_to(get("/" + std::string(300, 'a'))).status, 414);
}

TEST(Requests, ofOtherMethodsAreRefused) {
  for (const char* method : {"POST", "HEAD", "PUT", "DELETE", "OPTIONS", "get", ""}) {
    Request request = get("/");
    request.method = method;
    EXPECT_EQ(answer_to(request).status, 405) << method;
  }
}

TEST(Requests, whoseHostIsAnotherOneAreRefused) {
  const auto status = [](const char* host, const Access& access = local()) {
    Request request = get("/scene.json");
    request.host = host;
    return answer_to(request, access).status;
  };
  for (const char* host : {"localhost:8080", "127.0.0.1:8080", "[::1]:8080"}) EXPECT_EQ(status(host), 200) << host;
  for (const char* host : {"evil.example:8080", "localhost", "localhost:80", "localhost:8081", "localhost:8080.evil",
                           "localhost.evil:8080", "192.168.2.2:8080", "", ":8080", "[::1]", "localhost:", "[::2]:8080",
                           "LOCALHOST:8080 ", "localhost:99999999999999999999"}) {
    EXPECT_EQ(status(host), 403) << host;
  }
  Request none = get("/");
  none.host.reset();
  EXPECT_EQ(answer_to(none).status, 400);
  // Of all addresses of a machine any is right, but no name.
  Access any = local();
  any.any_address = true;
  EXPECT_EQ(status("192.168.2.2:8080", any), 200);
  EXPECT_EQ(status("[fe80::1]:8080", any), 200);
  EXPECT_EQ(status("evil.example:8080", any), 403);
  Access usual = local();
  usual.port = 80;
  EXPECT_EQ(status("localhost", usual), 200);
}

TEST(Requests, ofPagesOfOtherOriginsAreRefused) {
  const auto status = [](const char* target, const char* site, const char* mode, const char* dest) {
    Request request = get(target);
    request.fetch_site = site;
    request.fetch_mode = mode;
    request.fetch_dest = dest;
    return answer_to(request).status;
  };
  EXPECT_EQ(status("/scene.json", "same-origin", "cors", "empty"), 200);
  EXPECT_EQ(status("/page.js", "same-origin", "same-origin", "worker"), 200);
  EXPECT_EQ(status("/", "none", "navigate", "document"), 200);
  EXPECT_EQ(status("/", "cross-site", "navigate", "document"), 200) << "a link to the page";
  EXPECT_EQ(status("/", "cross-site", "navigate", "iframe"), 403);
  EXPECT_EQ(status("/", "cross-site", "no-cors", "image"), 403);
  EXPECT_EQ(status("/scene.json", "cross-site", "navigate", "document"), 403);
  EXPECT_EQ(status("/page.js", "cross-site", "no-cors", "script"), 403);
  EXPECT_EQ(status("/scene.json", "same-site", "cors", "empty"), 403) << "another port is another origin";
  for (const char* origin : {"http://evil.example", "null", "https://localhost:8080", "http://localhost:8081", ""}) {
    Request request = get("/scene.json");
    request.origin = origin;
    EXPECT_EQ(answer_to(request).status, 403) << origin;
  }
  Request own = get("/scene.json");
  own.origin = "http://localhost:8080";
  EXPECT_EQ(answer_to(own).status, 200);
}

TEST(Requests, withoutTheTokenAreToldNothing) {
  Access access = local();
  access.token = "0123456789abcdef";
  const auto status = [&](const char* target) { return answer_to(get(target), access).status; };
  EXPECT_EQ(status("/0123456789abcdef/"), 200);
  EXPECT_EQ(status("/0123456789abcdef/scene.json"), 200);
  EXPECT_EQ(status("/0123456789abcdef/nothing"), 404);
  for (const char* target : {"/", "/scene.json", "/0123456789abcdef", "/0123456789abcdeg/", "/0123456789abcde/",
                             "/0123456789abcdef0/", "//0123456789abcdef/", "/page.js", "/?0123456789abcdef/"}) {
    EXPECT_EQ(status(target), 403) << target;
  }
}

Access of_vehicle() {
  return {.port = 7360, .hosts = {"localhost", "127.0.0.1"}, .readers = Readers::kLocalNetwork};
}

TEST(Requests, ofTheLocalNetworkMayNameTheVehicleAsItDoes) {
  const auto status = [](const char* host) {
    Request request = get("/scene.json");
    request.host = host;
    return answer_to(request, of_vehicle()).status;
  };
  // The proxy passes the name on without a port.
  for (const char* host :
       {"127.0.0.1:7360", "192.168.2.2", "192.168.2.2:7360", "blueos.local", "blueos.local:7360", "blueos", "10.0.0.7",
        "172.16.0.1", "172.31.255.255", "169.254.1.1", "100.64.0.1", "[fe80::1]", "[fd12::1]:7360"}) {
    EXPECT_EQ(status(host), 200) << host;
  }
  for (const char* host : {"evil.example",
                           "evil.example:7360",
                           "8.8.8.8",
                           "8.8.8.8:7360",
                           "172.32.0.1",
                           "172.15.255.255",
                           "192.169.0.1",
                           "100.128.0.1",
                           "11.0.0.1",
                           "",
                           ":7360",
                           "10.1",
                           "10.0.0.1.evil.example",
                           "blueos.local.evil.example",
                           "blueos.local.",
                           "[2001:db8::1]",
                           "[fe80::1",
                           "10.0.0.1:x",
                           "a/b",
                           "a b",
                           "x@blueos.local"}) {
    EXPECT_EQ(status(host), 403) << host;
  }
  // Elsewhere such names are those of foreign pages.
  Request named = get("/scene.json");
  named.host = "blueos.local:8080";
  EXPECT_EQ(answer_to(named).status, 403);
}

TEST(Requests, ofPagesOfOtherOriginsAreRefusedInTheLocalNetworkToo) {
  const auto status = [](const char* host, const char* origin) {
    Request request = get("/scene.json");
    request.host = host;
    request.origin = origin;
    return answer_to(request, of_vehicle()).status;
  };
  EXPECT_EQ(status("blueos.local", "http://blueos.local"), 200);
  EXPECT_EQ(status("blueos.local", "https://blueos.local"), 200) << "the proxy has a certificate";
  EXPECT_EQ(status("192.168.2.2:7360", "http://192.168.2.2:7360"), 200);
  for (const char* origin :
       {"http://evil.example", "null", "http://blueos.local:81", "http://192.168.2.2", "file://"}) {
    EXPECT_EQ(status("blueos.local", origin), 403) << origin;
  }
  EXPECT_EQ(status("192.168.2.2:7360", "http://192.168.2.2"), 403) << "another port is another origin";
  const auto framed = [](const char* target, const Access& access) {
    Request request = get(target);
    request.host = "localhost:" + std::to_string(access.port);
    request.fetch_site = "same-site";
    request.fetch_mode = "navigate";
    request.fetch_dest = "iframe";
    return answer_to(request, access).status;
  };
  EXPECT_EQ(framed("/", of_vehicle()), 200);
  EXPECT_EQ(framed("/scene.json", of_vehicle()), 403);
  EXPECT_EQ(framed("/", local()), 403);
}

TEST(Requests, ofBlueOsAndCockpitAreAnsweredForTheLocalNetworkOnly) {
  const auto answer = [](const char* target, const char* host, const char* method = "GET") {
    Request request = get(target);
    request.host = host;
    request.method = method;
    request.origin = "http://cockpit.example";
    request.fetch_site = "cross-site";
    return blueos_answer(request, of_vehicle());
  };
  for (const char* target : {"/register_service", "/cockpit_extras.json", "/icon.svg"}) {
    const auto direct = answer(target, "192.168.2.2:7360");
    ASSERT_TRUE(direct) << target;
    EXPECT_EQ(direct->status, 200);
    ASSERT_EQ(direct->headers.size(), 1U);
    EXPECT_EQ(direct->headers[0], (Header{"Access-Control-Allow-Origin", "*"}));
    const auto by_proxy = answer(target, "192.168.2.2");
    ASSERT_TRUE(by_proxy) << target;
    EXPECT_TRUE(by_proxy->headers.empty()) << "the proxy adds it; twice it counts as none";
    EXPECT_FALSE(answer(target, "evil.example")) << target;
    EXPECT_FALSE(answer(target, "192.168.2.2", "POST")) << target;
    EXPECT_FALSE(blueos_answer(get(target), local())) << target;
  }
  EXPECT_FALSE(answer("/", "192.168.2.2"));
  EXPECT_FALSE(answer("/register_service/", "192.168.2.2"));
  const std::string service = text_of(*answer("/register_service", "127.0.0.1:7360"));
  for (const char* key : {"name", "description", "icon", "company", "version", "webpage", "api"}) {
    EXPECT_NE(service.find("\"" + std::string(key) + "\": \""), std::string::npos) << key << " is needed by BlueOS";
  }
  EXPECT_NE(service.find("\"cockpit\": \"/cockpit_extras.json\""), std::string::npos);
  EXPECT_NE(text_of(*answer("/cockpit_extras.json", "127.0.0.1:7360")).find("\"/icon.svg\""), std::string::npos);
}

TEST(Requests, secretsAreComparedAsAWhole) {
  EXPECT_TRUE(is_same_secret("abc", "abc"));
  for (const char* other : {"", "ab", "abcd", "abd", "bbc", "aBc"}) EXPECT_FALSE(is_same_secret(other, "abc")) << other;
  EXPECT_FALSE(is_same_secret("aaa", "a"));
  EXPECT_FALSE(is_same_secret("a", "aaa"));
}

TEST(Requests, answersLetNoOtherPageReadOrRunScripts) {
  std::string all;
  for (const auto& [name, value] : fixed_headers()) all += std::string(name) + ": " + std::string(value) + "\n";
  for (const char* part : {"default-src 'none'", "script-src 'self';", "frame-ancestors 'none'", "nosniff", "no-store",
                           "Cross-Origin-Resource-Policy: same-origin"}) {
    EXPECT_NE(all.find(part), std::string::npos) << part;
  }
  EXPECT_EQ(all.find("unsafe"), std::string::npos);
  all.clear();
  for (const auto& [name, value] : fixed_headers(Readers::kLocalNetwork)) all += std::string(value) + "\n";
  EXPECT_NE(all.find("default-src 'none'"), std::string::npos);
  EXPECT_EQ(all.find("frame-ancestors"), std::string::npos) << "BlueOS shows the page in a frame";
}

TEST(Requests, damagedOnesAreAnsweredAsPromised) {
  std::vector<std::vector<std::uint8_t>> seeds;
  for (const auto& entry : std::filesystem::directory_iterator(PINGVOX_FUZZ_CORPUS "/requests")) {
    const auto file = read_file(entry.path().string());
    ASSERT_TRUE(file) << file.error().message;
    seeds.push_back(file->bytes);
  }
  ASSERT_GE(seeds.size(), 10U);
  std::size_t told = 0, cases = 0;
  for (const auto& seed : seeds) told += fuzz::requests(seed) > 0 ? 1 : 0;
  EXPECT_GE(told, 8U);
  std::mt19937_64 random(52);
  for (; cases < 3000; ++cases) {
    const auto bytes = mutant(seeds[random() % seeds.size()], seeds[random() % seeds.size()], random);
    ASSERT_NO_THROW(fuzz::requests(bytes)) << std::string(bytes.begin(), bytes.end());
  }
  EXPECT_EQ(cases, 3000U);
}

TEST(Requests, ofControlsAreWhatTheySay) {
  using namespace live_control;
  const auto head_of = [](std::string_view query) {
    const auto control = control_of("control/head", query);
    return control ? std::optional(std::get<DriveHead>(*control)) : std::nullopt;
  };
  const auto all = head_of("range=20.5&gain=high&step=1.8&sector=-60,60");
  ASSERT_TRUE(all && all->range_m && all->step_deg && all->sector_deg);
  EXPECT_EQ(*all->range_m, 20.5);
  EXPECT_EQ(all->gain, ReceiverGain::kHigh);
  EXPECT_EQ(*all->step_deg, 1.8);
  EXPECT_EQ(*all->sector_deg, (std::array{-60.0, 60.0}));
  EXPECT_FALSE(all->is_full_turn);
  EXPECT_TRUE(head_of("sector=full")->is_full_turn);
  for (const char* query : {"", "range", "range=", "range=2x", "range=nan", "range=inf", "step=-inf", "sector=",
                            "sector=1", "sector=1,2,3", "sector=nan,1", "gain=loud", "speed=1", "&range=2"}) {
    EXPECT_FALSE(head_of(query)) << query;
  }
  EXPECT_TRUE(std::holds_alternative<BeginRecording>(*control_of("control/recording/begin", "")));
  EXPECT_TRUE(std::holds_alternative<EndRecording>(*control_of("control/recording/end", "")));
  EXPECT_TRUE(std::holds_alternative<BeginNewMap>(*control_of("control/map/new", "")));
  EXPECT_FALSE(control_of("control/map/new", "now"));
  EXPECT_FALSE(control_of("control/", ""));
  EXPECT_FALSE(control_of("state", ""));
}

TEST(Requests, ofControlsNeedTheTokenAndThePageItself) {
  Access access = local();
  access.token = "0123456789abcdef";
  access.is_open = true;
  Request request{.method = "POST", .target = "/0123456789abcdef/control/map/new", .host = "localhost:8080"};
  EXPECT_TRUE(fuzz::controls(request, access));
  EXPECT_TRUE(check_request(request, access)->may_control);
  request.origin = "http://evil.example";
  EXPECT_FALSE(fuzz::controls(request, access));
  request.origin = "http://localhost:8080";
  EXPECT_TRUE(fuzz::controls(request, access));
  request.target = "/control/map/new";
  EXPECT_TRUE(fuzz::controls(request, access));
  EXPECT_FALSE(check_request(request, access)->may_control) << "what it asks for is refused";
}

}  // namespace
}  // namespace pingvox::web
