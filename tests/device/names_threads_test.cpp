// Hosts whose name server does not answer.

#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netdb.h>

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "device/internal/a50_receiver.hpp"
#include "device/internal/link.hpp"
#include "device/internal/live_source.hpp"

namespace {

/// The server that knows "silent.test". It answers when the test lets it, or fails after ten seconds.
class NameServer {
 public:
  int look_up() {
    std::unique_lock lock(mutex_);
    ++asked_;
    changed_.notify_all();
    const bool answers = changed_.wait_for(lock, std::chrono::seconds(10), [this] { return answers_; });
    ++answered_;
    changed_.notify_all();
    return answers ? EAI_NONAME : EAI_AGAIN;
  }
  /// Lets it answer, and waits until all that were asked are answered.
  void answer() {
    std::unique_lock lock(mutex_);
    answers_ = true;
    changed_.notify_all();
    changed_.wait(lock, [this] { return answered_ == asked_; });
  }
  void wait_until_asked(int times) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this, times] { return asked_ >= times; });
  }
  int answered() {
    const std::scoped_lock lock(mutex_);
    return answered_;
  }
  int asked() {
    const std::scoped_lock lock(mutex_);
    return asked_;
  }
  void start() {
    const std::scoped_lock lock(mutex_);
    answers_ = false;
    asked_ = answered_ = 0;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool answers_ = false;
  int asked_ = 0, answered_ = 0;
};

NameServer server;

}  // namespace

/// In place of the system's.
extern "C" int getaddrinfo(const char* host, const char* service, const addrinfo* wanted, addrinfo** found) {
  const bool is_numeric = wanted != nullptr && (wanted->ai_flags & AI_NUMERICHOST) != 0;
  if (host != nullptr && std::string_view(host) == "silent.test" && !is_numeric) return server.look_up();
  using GetAddrInfo = int (*)(const char*, const char*, const addrinfo*, addrinfo**);
  const auto real = reinterpret_cast<GetAddrInfo>(::dlsym(RTLD_NEXT, "getaddrinfo"));
  return real(host, service, wanted, found);
}

namespace pingvox {
namespace {

using testing::HasSubstr;

class SilentNameServer : public testing::Test {
 protected:
  void SetUp() override { server.start(); }
  void TearDown() override { server.answer(); }
};

// Each look at the name held all beams up for ten seconds.
TEST_F(SilentNameServer, HoldsNoDvlUp) {
  Result<A50Receiver> receiver = A50Receiver::make("tcp://silent.test:16171", std::nullopt, 0.0);
  ASSERT_TRUE(receiver);
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(receiver->read(0.1 * i).empty());
  EXPECT_EQ(server.answered(), 0) << "it was waited for";
  server.wait_until_asked(1);
  EXPECT_EQ(server.asked(), 1) << "once at a time";
  server.answer();
  for (int i = 0; i < 60'000 && receiver->status().problem.empty(); ++i) {
    receiver->read(10.0);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_THAT(receiver->status().problem, HasSubstr("tcp://silent.test:16171: "));
}

TEST_F(SilentNameServer, HoldsNoHeadUp) {
  std::vector<Beam> beams;
  const auto ping360 = ping360_source("udp://silent.test:9092", {}, std::nullopt, 0.0);
  const auto micron = micron_source("tcp://silent.test:9092", {}, std::nullopt, 0.0);
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(ping360->step(0.1 * i, beams));
    ASSERT_TRUE(micron->step(0.1 * i, beams));
    EXPECT_GT(ping360->due_s(), 0.1 * i) << "no loop without a pause";
  }
  EXPECT_EQ(server.answered(), 0) << "it was waited for";
  server.wait_until_asked(2);
}

TEST_F(SilentNameServer, AnOpeningMayBeGivenUp) {
  {
    LinkOpening opening("udp://silent.test:1");
    EXPECT_FALSE(opening.take());
    server.wait_until_asked(1);
  }
  EXPECT_EQ(server.answered(), 0) << "the thread has outlived it";
}

TEST(LinkOpening, OpensWhatLinkOpens) {
  for (const char* address : {"udp://127.0.0.1:9", "tcp://[::1]:9", "/dev/null", "http://a:1", "udp://a"}) {
    LinkOpening opening(address);
    std::optional<Result<Link>> opened = opening.take();
    ASSERT_TRUE(opened) << address;
    const Result<Link> link = Link::open(address);
    ASSERT_EQ(opened->has_value(), link.has_value()) << address;
    if (!link) {
      EXPECT_EQ(opened->error().message, link.error().message);
    }
  }
  LinkOpening named("udp://localhost:9");
  std::optional<Result<Link>> opened;
  for (int i = 0; i < 60'000 && !opened; ++i) {
    opened = named.take();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ASSERT_TRUE(opened);
  ASSERT_TRUE(*opened) << opened->error().message;
  EXPECT_EQ((*opened)->address(), "udp://localhost:9");
}

}  // namespace
}  // namespace pingvox
