#include "pingvox/web/server.hpp"

#include "base/option_errors.hpp"

#ifdef PINGVOX_HAS_PAGE
// The only source that includes this library.
#include <httplib.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/random.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include "base/without_exceptions.hpp"
#include "io/internal/descriptor.hpp"
#include "web/blueos.hpp"
#endif

namespace pingvox::web {

Result<void> ServerOptions::validate() const {
  OptionErrors errors;
  constexpr int kHighestPort = 65535;
  errors.require_within("port", port, 0, kHighestPort);
  constexpr double kLongest_s = 3600.0;
  errors.require_within("longest_request_s", longest_request_s, 0.001, kLongest_s);
  if (address.empty()) errors.add("address must not be empty");
  return errors.result("server");
}

#ifdef PINGVOX_HAS_PAGE
namespace {

using Clock = std::chrono::steady_clock;

/// A connection for one request, closed when the request is late or too long, when the client reads too slowly, and
/// when the server stops.
class LimitedStream final : public httplib::Stream {
 public:
  LimitedStream(int socket, int stops, Clock::duration longest) : socket_(socket), stops_(stops), longest_(longest) {}

  /// The answer lasts as long as the client reads it.
  void keep_open() { is_kept_open_ = true; }

  /// Ends the answer. What the client still sends is read for a moment: it would take an error for the answer if the
  /// connection was closed before.
  void finish() {
    constexpr std::chrono::seconds kMoment{1};
    constexpr std::size_t kMaxPieces = 256;
    ::shutdown(socket_, SHUT_WR);
    const Clock::time_point until = Clock::now() + kMoment;
    for (std::size_t i = 0; i < kMaxPieces && is_ready(POLLIN, until); ++i) {
      if (::recv(socket_, buffer_.data(), buffer_.size(), 0) <= 0) return;
    }
  }

  bool is_readable() const override { return !buffered().empty() || is_ready(POLLIN, begun_ + longest_); }
  bool is_writable() const override {
    return is_ready(POLLOUT, is_kept_open_ ? Clock::now() + kOnePart : write_deadline());
  }

  ssize_t read(char* to, std::size_t size) override {
    if (buffered().empty()) {
      if (received_ >= kLongestRequest || !is_readable()) return -1;
      const ssize_t got = ::recv(socket_, buffer_.data(), std::min(buffer_.size(), kLongestRequest - received_), 0);
      if (got <= 0) return got;
      first_ = 0;
      last_ = static_cast<std::size_t>(got);
      received_ += last_;
    }
    const std::string_view here = buffered().substr(0, size);
    std::memcpy(to, here.data(), here.size());
    first_ += here.size();
    return static_cast<ssize_t>(here.size());
  }

  ssize_t write(const char* from, std::size_t size) override {
    std::size_t done = 0;
    while (done < size) {
      if (!is_writable()) return -1;
      const ssize_t sent = ::send(socket_, from + done, size - done, MSG_NOSIGNAL | MSG_DONTWAIT);
      if (sent < 0 && (errno == EAGAIN || errno == EINTR)) continue;
      if (sent <= 0) return -1;
      done += static_cast<std::size_t>(sent);
      sent_ += static_cast<std::size_t>(sent);
    }
    return static_cast<ssize_t>(done);
  }

  void get_remote_ip_and_port(std::string& ip, int& port) const override {
    ip.clear();
    port = 0;
  }
  void get_local_ip_and_port(std::string& ip, int& port) const override { get_remote_ip_and_port(ip, port); }
  socket_t socket() const override { return socket_; }

 private:
  static constexpr std::size_t kLongestRequest = 16'384;
  static constexpr std::chrono::seconds kFirstBytes{20}, kOnePart{10};
  static constexpr std::size_t kSlowest_bytes_s = 20'000;

  std::string_view buffered() const { return std::string_view(buffer_.data(), last_).substr(first_); }

  Clock::time_point write_deadline() const {
    return begun_ + longest_ + kFirstBytes + std::chrono::seconds(sent_ / kSlowest_bytes_s);
  }

  bool is_ready(short event, Clock::time_point until) const {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now());
    std::array<pollfd, 2> files = {pollfd{socket_, event, 0}, pollfd{stops_, POLLIN, 0}};
    const int found = ::poll(files.data(), files.size(), static_cast<int>(std::max<std::int64_t>(left.count(), 0)));
    return found > 0 && files[0].revents != 0 && files[1].revents == 0;
  }

  int socket_, stops_;
  Clock::duration longest_;  ///< of a request
  bool is_kept_open_ = false;
  std::array<char, 4096> buffer_{};
  std::size_t first_ = 0, last_ = 0;        ///< of what is in the buffer
  std::size_t received_ = 0, sent_ = 0;     ///< of this request
  Clock::time_point begun_ = Clock::now();  ///< when it was waited for
};

/// Reads requests and writes answers; the rest is ours.
class LimitedServer final : public httplib::Server {
 public:
  LimitedServer(int stops, Clock::duration longest_request) : stops_(stops), longest_request_(longest_request) {}

 private:
  bool process_and_close_socket(socket_t socket) override {
    LimitedStream stream(socket, stops_, longest_request_);
    bool is_closed = false;
    // The page requests no ranges.
    const auto prepare = [&stream](httplib::Request& request) {
      request.ranges.clear();
      if (request.path.ends_with("/events")) stream.keep_open();
    };
    // One request for each connection: what follows a refused one is not parsed as another.
    const bool is_done = process_request(stream, true, is_closed, prepare);
    if (is_done) stream.finish();
    ::close(socket);
    return true;
  }

  int stops_;
  Clock::duration longest_request_;
};

std::optional<std::string> header_of(const httplib::Request& request, const std::string& name) {
  if (request.get_header_value_count(name) != 1) return std::nullopt;
  return request.get_header_value(name);
}

Request request_of(const httplib::Request& from) {
  return {.method = from.method,
          .target = from.target,
          .host = header_of(from, "Host"),
          .origin = header_of(from, "Origin"),
          .fetch_site = header_of(from, "Sec-Fetch-Site"),
          .fetch_mode = header_of(from, "Sec-Fetch-Mode"),
          .fetch_dest = header_of(from, "Sec-Fetch-Dest")};
}

void put(const Answer& answer, httplib::Response& to) {
  to.status = answer.status;
  if (answer.status == 405) to.set_header("Allow", "GET");
  for (const auto& [name, value] : answer.headers) to.set_header(std::string(name), std::string(value));
  if (answer.next) {
    const auto send_next = [next = answer.next](std::size_t, httplib::DataSink& sink) {
      const std::optional<std::string> part = next();
      if (part) return sink.write(part->data(), part->size());
      sink.done();
      return true;
    };
    to.set_chunked_content_provider(std::string(answer.type), send_next);
    return;
  }
  if (answer.body.empty()) {
    to.set_content("", std::string(answer.type));
    return;
  }
  to.set_content_provider(
      answer.body.size(), std::string(answer.type),
      [body = answer.body, owned = answer.owned](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
        constexpr std::size_t kPiece = std::size_t{1} << 16;
        const auto piece = body.subspan(offset, std::min(length, kPiece));
        const std::string text(piece.begin(), piece.end());
        return sink.write(text.data(), text.size());
      });
}

Result<std::string> random_token() {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::array<std::uint8_t, 16> random{};
  if (::getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size())) {
    return os_error("random numbers", errno);
  }
  std::string token;
  for (const std::uint8_t byte : random) {
    token += kDigits[byte >> 4];
    token += kDigits[byte & 15];
  }
  return token;
}

bool is_loopback(std::string_view address) {
  const bool is_of_numbers = address.find_first_not_of("0123456789.") == std::string_view::npos;
  return address == "localhost" || address == "::1" || (address.starts_with("127.") && is_of_numbers);
}

/// An address as a browser writes it.
std::string host_of(const std::string& address) {
  return address.find(':') == std::string::npos ? address : "[" + address + "]";
}

/// An address that stands for all of this machine names none that a browser can open.
bool is_any(std::string_view address) {
  return address == "0.0.0.0" || address == "::";
}

}  // namespace

struct Server::Parts {
  Parts(Responder answers, Descriptor event, Clock::duration longest_request)
      : responder(std::move(answers)), stops(std::move(event)), http(stops.get(), longest_request) {}
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;
  ~Parts() {
    constexpr std::uint64_t kOne = 1;
    // It fails only where the event is set already.
    static_cast<void>(!::write(stops.get(), &kOne, sizeof kOne));
    http.stop();
    if (listener.joinable()) listener.join();
  }

  Responder responder;
  Access access;
  Descriptor stops;  ///< event: the server stops
  LimitedServer http;
  std::atomic<bool> has_ended = false;
  std::string url;
  std::thread listener;
};

Result<Server> Server::start(Answers answers, const ServerOptions& options) {
  const auto shared = std::make_shared<const Answers>(std::move(answers));
  return start([shared](const Request& request, const Access& access) { return shared->answer(request, access); },
               options);
}

Result<Server> Server::start(Responder responder, const ServerOptions& options) {
  if (const auto valid = options.validate(); !valid) return tl::unexpected(valid.error());
  return detail::without_exceptions([&]() -> Result<Server> {
    const auto longest_request =
        std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options.longest_request_s));
    auto parts = std::make_unique<Parts>(std::move(responder), Descriptor(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
                                         longest_request);
    if (!parts->stops.valid()) return os_error("events", errno);
    constexpr std::size_t kThreads = 16;
    httplib::Server& http = parts->http;
    http.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };  // NOLINT(*-owning-memory): httplib's way
    // The library's own options let two servers have one port.
    http.set_socket_options([](socket_t socket) {
      const int yes = 1;
      ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    httplib::Headers headers;
    for (const auto& [name, value] : fixed_headers(options.readers)) headers.emplace(name, value);
    http.set_default_headers(std::move(headers));
    http.set_pre_routing_handler([from = parts.get()](const httplib::Request& request, httplib::Response& response) {
      const Request asked = request_of(request);
      const std::optional<Answer> told = blueos_answer(asked, from->access);
      put(told ? *told : from->responder(asked, from->access), response);
      return httplib::Server::HandlerResponse::Handled;
    });
    const int port = options.port != 0 ? options.port : http.bind_to_any_port(options.address);
    if (port <= 0 || (options.port != 0 && !http.bind_to_port(options.address, port))) {
      return fail(Error::Code::kIo, options.port != 0
                                        ? fmt::format("{} port {}: cannot listen: is the port in use, or the "
                                                      "address that of another machine?",
                                                      options.address, options.port)
                                        : fmt::format("{}: cannot listen", options.address));
    }
    parts->access = {.port = port, .hosts = {"localhost", "127.0.0.1", "[::1]"}, .readers = options.readers};
    std::string path = "/";
    const bool is_near = is_loopback(options.address);
    const bool has_token = !is_near || options.token == WantToken::kForControl;
    if (has_token && options.readers == Readers::kWithToken) {
      Result<std::string> token = random_token();
      if (!token) return tl::unexpected(token.error());
      parts->access.token = *std::move(token);
      parts->access.is_open = is_near;
      path += parts->access.token + "/";
    }
    parts->access.hosts.push_back(host_of(options.address));
    parts->access.any_address = is_any(options.address);
    parts->url = fmt::format("http://{}:{}{}", host_of(options.address), port, path);
    parts->listener = std::thread([from = parts.get()] {
      from->http.listen_after_bind();
      from->has_ended = true;
    });
    // A server that does not run yet cannot be stopped.
    while (!http.is_running() && !parts->has_ended) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return Server(std::move(parts));
  });
}

#else

struct Server::Parts {
  std::string url;
};

Result<Server> Server::start(Answers, const ServerOptions&) {
  return fail(Error::Code::kUnsupported, "this build has no server");
}

Result<Server> Server::start(Responder, const ServerOptions&) {
  return fail(Error::Code::kUnsupported, "this build has no server");
}

#endif

Server::Server(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Server::Server(Server&&) noexcept = default;
Server& Server::operator=(Server&&) noexcept = default;
Server::~Server() = default;

const std::string& Server::url() const {
  return parts_->url;
}

}  // namespace pingvox::web
