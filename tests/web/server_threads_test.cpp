#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "fuzz/bodies/requests.hpp"
#include "io/internal/descriptor.hpp"
#include "pingvox/web/server.hpp"

// The server by its socket, with a client that knows nothing of HTTP.
namespace pingvox::web {
namespace {

const Page kPage{"<html>", "script", "style"};

#define PINGVOX_NEEDS_SERVER() \
  if (!built_in_page()) GTEST_SKIP() << "built without the server"

Answers small_answers() {
  return {fuzz::small_scene(), kPage};
}

int port_of(const std::string& url) {
  return std::stoi(url.substr(url.find(':', 7) + 1));
}

class Client {
 public:
  explicit Client(const Server& server) : port_(port_of(server.url())), socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port_));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const auto* const any = reinterpret_cast<const sockaddr*>(&address);
    EXPECT_EQ(::connect(socket_.get(), any, sizeof address), 0);
  }

  std::string host() const { return "127.0.0.1:" + std::to_string(port_); }

  void send(const std::string& text) { ::send(socket_.get(), text.data(), text.size(), MSG_NOSIGNAL); }

  /// All that comes until the server closes.
  std::string rest() {
    std::string all;
    std::array<char, 4096> buffer{};
    for (;;) {
      const ssize_t got = ::recv(socket_.get(), buffer.data(), buffer.size(), 0);
      if (got <= 0) return all;
      all.append(buffer.data(), static_cast<std::size_t>(got));
    }
  }

  std::string get(const std::string& target, const std::string& headers = "") {
    send("GET " + target + " HTTP/1.1\r\nHost: " + host() + "\r\n" + headers + "Connection: close\r\n\r\n");
    return rest();
  }

 private:
  int port_;
  Descriptor socket_;
};

TEST(Server, answersWithHeadersAndBody) {
  PINGVOX_NEEDS_SERVER();
  const Result<Server> server = Server::start(small_answers());
  ASSERT_TRUE(server) << server.error().message;
  EXPECT_TRUE(server->url().starts_with("http://127.0.0.1:")) << server->url();
  const std::string answer = Client(*server).get("/page.js");
  EXPECT_TRUE(answer.starts_with("HTTP/1.1 200")) << answer;
  EXPECT_TRUE(answer.ends_with("\r\n\r\nscript")) << answer;
  for (const auto& [name, value] : fixed_headers()) {
    EXPECT_NE(answer.find(std::string(name) + ": " + std::string(value)), std::string::npos) << name;
  }
}

TEST(Server, isAnExtensionOfBlueOsWithoutAToken) {
  PINGVOX_NEEDS_SERVER();
  const Result<Server> server =
      Server::start(small_answers(), {.address = "0.0.0.0", .readers = Readers::kLocalNetwork});
  ASSERT_TRUE(server) << server.error().message;
  const std::string service = Client(*server).get("/register_service", "Origin: http://other.local\r\n");
  EXPECT_TRUE(service.starts_with("HTTP/1.1 200")) << service;
  EXPECT_NE(service.find("\r\nAccess-Control-Allow-Origin: *\r\n"), std::string::npos) << service;
  const std::string page = Client(*server).get("/");
  EXPECT_TRUE(page.ends_with("\r\n\r\n<html>")) << page;
  EXPECT_EQ(page.find("frame-ancestors"), std::string::npos) << page;
  EXPECT_EQ(page.find("Access-Control-Allow-Origin"), std::string::npos) << page;
}

TEST(Server, sendsBytesAsTheyAre) {
  PINGVOX_NEEDS_SERVER();
  const Result<Server> server = Server::start(small_answers());
  ASSERT_TRUE(server) << server.error().message;
  const std::string answer = Client(*server).get("/map/0/cells", "Accept-Encoding: gzip, br\r\nRange: bytes=0-3\r\n");
  const Bytes bytes = *cells_bytes(fuzz::small_scene().maps[0].map);
  EXPECT_TRUE(answer.starts_with("HTTP/1.1 200")) << answer;
  EXPECT_TRUE(answer.ends_with("\r\n\r\n" + std::string(bytes.begin(), bytes.end())));
}

TEST(Server, refusesWhatThePageDoesNotAsk) {
  PINGVOX_NEEDS_SERVER();
  const Result<Server> server = Server::start(small_answers());
  ASSERT_TRUE(server) << server.error().message;
  const auto status = [&](const std::string& text) {
    Client client(*server);
    client.send(text);
    const std::string answer = client.rest();
    return answer.size() < 12 ? answer : answer.substr(9, 3);
  };
  const std::string host = "Host: " + Client(*server).host() + "\r\nConnection: close\r\n";
  EXPECT_EQ(status("GET / HTTP/1.1\r\nConnection: close\r\n\r\n"), "400") << "no host";
  EXPECT_EQ(status("GET / HTTP/1.1\r\n" + host + "Host: evil\r\n\r\n"), "400") << "two hosts";
  EXPECT_EQ(status("GET / HTTP/1.1\r\nHost: evil\r\nConnection: close\r\n\r\n"), "403");
  EXPECT_EQ(status("GET /scene.json HTTP/1.1\r\n" + host + "Origin: http://evil\r\n\r\n"), "403");
  EXPECT_EQ(status("POST / HTTP/1.1\r\n" + host + "Content-Length: 3\r\n\r\nabc"), "405");
  EXPECT_EQ(status("HEAD / HTTP/1.1\r\n" + host + "\r\n"), "405");
  EXPECT_EQ(status("GET /../../etc/passwd HTTP/1.1\r\n" + host + "\r\n"), "404");
  EXPECT_EQ(status("GET /%2e%2e/etc/passwd HTTP/1.1\r\n" + host + "\r\n"), "404");
  EXPECT_EQ(status("hello\r\n\r\n"), "400");
}

TEST(Server, givesUpLongRequests) {
  PINGVOX_NEEDS_SERVER();
  const Result<Server> server = Server::start(small_answers());
  ASSERT_TRUE(server) << server.error().message;
  for (const std::string& text :
       {"GET /" + std::string(100'000, 'a') + " HTTP/1.1\r\n\r\n",
        "GET / HTTP/1.1\r\nX: " + std::string(100'000, 'a') + "\r\n\r\n", "GET / HTTP/1.1\r\n" + [] {
          std::string many;
          for (int i = 0; i < 5000; ++i) many += "X: a\r\n";
          return many;
        }()}) {
    Client client(*server);
    client.send(text);
    const std::string answer = client.rest();
    EXPECT_EQ(answer.find("200"), std::string::npos) << answer.substr(0, 200);
    EXPECT_LT(answer.size(), 2000U);
  }
  EXPECT_TRUE(Client(*server).get("/").starts_with("HTTP/1.1 200")) << "others are served all the same";
}

TEST(Server, givesUpSlowRequests) {
  PINGVOX_NEEDS_SERVER();
  const Result<Server> server = Server::start(small_answers(), {.longest_request_s = 0.2});
  ASSERT_TRUE(server) << server.error().message;
  Client client(*server);
  client.send("GET / HTTP/1.1\r\n");
  EXPECT_EQ(client.rest().find("200"), std::string::npos) << "ends by itself, as the request is never whole";
}

TEST(Server, takesWhatFollowsARequestForNoOther) {
  PINGVOX_NEEDS_SERVER();
  const Result<Server> server = Server::start(small_answers());
  ASSERT_TRUE(server) << server.error().message;
  Client client(*server);
  const std::string get = "GET /page.css HTTP/1.1\r\nHost: " + client.host() + "\r\n\r\n";
  client.send(get + get);
  const std::string answer = client.rest();
  EXPECT_TRUE(answer.ends_with("\r\n\r\nstyle")) << answer;
  EXPECT_EQ(answer.rfind("HTTP/1.1"), 0U) << answer;
}

TEST(Server, servesManyAtOnce) {
  PINGVOX_NEEDS_SERVER();
  const Result<Server> server = Server::start(small_answers());
  ASSERT_TRUE(server) << server.error().message;
  std::vector<std::thread> threads;
  std::array<int, 8> done{};
  for (int& mine : done) {
    threads.emplace_back([&server, &mine] {
      for (int i = 0; i < 20; ++i) mine += Client(*server).get("/map/0/cells").starts_with("HTTP/1.1 200") ? 1 : 0;
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const int mine : done) EXPECT_EQ(mine, 20);
}

TEST(Server, stopsWhileClientsWait) {
  PINGVOX_NEEDS_SERVER();
  std::optional<Result<Server>> server = Server::start(small_answers(), {.longest_request_s = 3600.0});
  ASSERT_TRUE(*server) << server->error().message;
  Client waits(**server), asks(**server);
  asks.send("GET / HTTP/1.1\r\nHost:");
  server.reset();  // would wait an hour for the rest of the request
  EXPECT_EQ(waits.rest(), "");
  EXPECT_EQ(asks.rest().find("200"), std::string::npos);
}

TEST(Server, needsAPortOfItsOwn) {
  PINGVOX_NEEDS_SERVER();
  const Result<Server> first = Server::start(small_answers());
  ASSERT_TRUE(first) << first.error().message;
  const int port = port_of(first->url());
  const Result<Server> second = Server::start(small_answers(), {.port = port});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, Error::Code::kIo);
  EXPECT_NE(second.error().message.find(std::to_string(port)), std::string::npos) << second.error().message;
}

TEST(Server, hasATokenWhereOtherMachinesReachIt) {
  PINGVOX_NEEDS_SERVER();
  const Result<Server> server = Server::start(small_answers(), {.address = "0.0.0.0"});
  ASSERT_TRUE(server) << server.error().message;
  const std::string url = server->url(), path = url.substr(url.find('/', 7));
  EXPECT_EQ(path.size(), 34U) << url;
  EXPECT_TRUE(Client(*server).get(path).starts_with("HTTP/1.1 200"));
  EXPECT_TRUE(Client(*server).get(path + "scene.json").starts_with("HTTP/1.1 200"));
  EXPECT_TRUE(Client(*server).get("/scene.json").starts_with("HTTP/1.1 403"));
  const Result<Server> other = Server::start(small_answers(), {.address = "0.0.0.0"});
  ASSERT_TRUE(other) << other.error().message;
  EXPECT_NE(other->url().substr(other->url().find('/', 7)), path);
}

TEST(Server, namesEachBrokenOption) {
  const auto broken = ServerOptions{.address = "", .port = 65536, .longest_request_s = 0.0}.validate();
  ASSERT_FALSE(broken);
  for (const char* part : {"address", "port", "longest_request_s"}) {
    EXPECT_NE(broken.error().message.find(part), std::string::npos) << part;
  }
  EXPECT_TRUE(ServerOptions{}.validate());
}

TEST(Server, failsAtAnAddressOfAnotherMachine) {
  PINGVOX_NEEDS_SERVER();
  const Result<Server> server = Server::start(small_answers(), {.address = "192.0.2.1"});
  ASSERT_FALSE(server);
  EXPECT_EQ(server.error().code, Error::Code::kIo);
}

}  // namespace
}  // namespace pingvox::web
