#include "fuzz/bodies/requests.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "pingvox/io/file.hpp"
#include "support/mutants.hpp"

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

}  // namespace
}  // namespace pingvox::web
