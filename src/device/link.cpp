#include "device/internal/link.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <mutex>
#include <optional>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

namespace pingvox {
namespace {

constexpr std::string_view kUdp = "udp://", kTcp = "tcp://";

struct HostAndPort {
  std::string host, port;
};

/// Of "HOST:PORT", "[HOST]:PORT" or ":PORT".
std::optional<HostAndPort> host_and_port(std::string_view text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) return std::nullopt;
  std::string_view host = text.substr(0, colon);
  const std::string_view port = text.substr(colon + 1);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  std::uint16_t number = 0;
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), number);
  if (error != std::errc{} || end != port.data() + port.size()) return std::nullopt;
  return HostAndPort{std::string(host), std::string(port)};
}

std::optional<speed_t> speed_of(int baud) {
  switch (baud) {
    case 9600:
      return B9600;
    case 19'200:
      return B19200;
    case 38'400:
      return B38400;
    case 57'600:
      return B57600;
    case 115'200:
      return B115200;
    case 230'400:
      return B230400;
    case 460'800:
      return B460800;
    case 921'600:
      return B921600;
    default:
      return std::nullopt;
  }
}

/// Bytes as they are, 8N1, without flow control. 0 or errno.
int make_raw(int terminal, speed_t speed) {
  termios settings = {};
  if (::tcgetattr(terminal, &settings) != 0) return errno;
  ::cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB);
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  ::cfsetispeed(&settings, speed);
  ::cfsetospeed(&settings, speed);
  return ::tcsetattr(terminal, TCSANOW, &settings) == 0 ? 0 : errno;
}

/// Of "udp://HOST:PORT" or "tcp://HOST:PORT".
Result<HostAndPort> remote_in(const std::string& address, std::string_view protocol) {
  std::optional<HostAndPort> parts = host_and_port(std::string_view(address).substr(protocol.size()));
  if (parts && !parts->host.empty()) return *std::move(parts);
  return fail(Error::Code::kBadOption, fmt::format("'{}': must be {}HOST:PORT", address, protocol));
}

struct SerialPort {
  std::string path;
  speed_t speed;
};

/// Of "/dev/ttyUSB0" or "/dev/ttyUSB0@57600".
Result<SerialPort> serial_port_in(const std::string& address) {
  constexpr int kDefaultBaud = 115'200;
  const std::size_t at = address.rfind('@');
  int baud = kDefaultBaud;
  if (at != std::string::npos) {
    const char* const last = address.data() + address.size();
    const auto [end, error] = std::from_chars(address.data() + at + 1, last, baud);
    if (error != std::errc{} || end != last) baud = 0;
  }
  const std::optional<speed_t> speed = speed_of(baud);
  if (speed) return SerialPort{address.substr(0, at), *speed};
  return fail(
      Error::Code::kBadOption,
      fmt::format("'{}': the baud rate must be 9600, 19200, 38400, 57600, 115200, 230400, 460800 or 921600", address));
}

tl::unexpected<Error> unknown_address(const std::string& address) {
  return fail(Error::Code::kBadOption,
              fmt::format("'{}': must be udp://HOST:PORT, tcp://HOST:PORT, or the path of a serial port", address));
}

/// The first IPv4 address, as heads and DVLs have, else the first.
const addrinfo* preferred(const addrinfo* found) {
  for (const addrinfo* one = found; one != nullptr; one = one->ai_next) {
    if (one->ai_family == AF_INET) return one;
  }
  return found;
}

/// "HOST:PORT" of a socket address; empty: it has none.
std::string text_of(const sockaddr* address, socklen_t size) {
  std::array<char, NI_MAXHOST> host = {};
  std::array<char, NI_MAXSERV> port = {};
  if (::getnameinfo(address, size, host.data(), host.size(), port.data(), port.size(),
                    NI_NUMERICHOST | NI_NUMERICSERV) != 0) {
    return {};
  }
  const bool is_v6 = address->sa_family == AF_INET6;
  return fmt::format("{}{}{}:{}", is_v6 ? "[" : "", host.data(), is_v6 ? "]" : "", port.data());
}

/// "udp://HOST:PORT" of a socket.
std::string address_of(int socket, std::string_view protocol) {
  sockaddr_storage own = {};
  socklen_t size = sizeof own;
  auto* address = reinterpret_cast<sockaddr*>(&own);
  if (::getsockname(socket, address, &size) != 0) return {};
  const std::string text = text_of(address, size);
  return text.empty() ? text : std::string(protocol) + text;
}

tl::unexpected<Error> look_up_error(const std::string& address, int error) {
  return fail(Error::Code::kIo, fmt::format("{}: {}", address, ::gai_strerror(error)));
}

}  // namespace

/// A host's, as far as it is known.
struct Link::SocketAddress {
  sockaddr_storage bytes = {};
  socklen_t size = 0;

  /// Looks a host up, which may take long where it is a name.
  /// @param socket_type, flags  for getaddrinfo
  /// @return its error, or 0
  int look_up(const HostAndPort& parts, int socket_type, int flags) {
    addrinfo wanted = {};
    wanted.ai_family = AF_UNSPEC;
    wanted.ai_socktype = socket_type;
    wanted.ai_flags = AI_NUMERICSERV | flags;
    addrinfo* all = nullptr;
    const char* const host = parts.host.empty() ? nullptr : parts.host.c_str();
    if (const int error = ::getaddrinfo(host, parts.port.c_str(), &wanted, &all)) return error;
    const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owner(all, &::freeaddrinfo);
    const addrinfo* const found = preferred(all);
    size = found->ai_addrlen;
    std::memcpy(&bytes, found->ai_addr, size);
    return 0;
  }
  const sockaddr* address() const { return reinterpret_cast<const sockaddr*>(&bytes); }
};

Result<Link> Link::open(const std::string& address) {
  if (address.starts_with(kUdp)) return open_socket(address, Kind::kSocket);
  if (address.starts_with(kTcp)) return open_socket(address, Kind::kStream);
  if (address.starts_with('/')) return open_serial_port(address);
  return unknown_address(address);
}

Result<void> Link::check(const std::string& address) {
  const auto nothing = [](const auto&) {};
  if (address.starts_with(kUdp)) return remote_in(address, kUdp).map(nothing);
  if (address.starts_with(kTcp)) return remote_in(address, kTcp).map(nothing);
  if (address.starts_with('/')) return serial_port_in(address).map(nothing);
  return unknown_address(address);
}

Result<Link> Link::listen(const std::string& address) {
  if (address.starts_with(kUdp)) return open_socket(address, Kind::kListeningSocket);
  if (address.starts_with(kTcp)) return open_socket(address, Kind::kListeningStream);
  if (address == "pty") return open_pseudo_terminal();
  return fail(Error::Code::kBadOption, fmt::format("'{}': must be udp://HOST:PORT, tcp://HOST:PORT or pty", address));
}

Result<Link> Link::open_socket(const std::string& address, Kind kind) {
  const bool listens = kind == Kind::kListeningSocket || kind == Kind::kListeningStream;
  const bool is_stream = kind == Kind::kStream || kind == Kind::kListeningStream;
  const std::string_view protocol = is_stream ? kTcp : kUdp;
  const std::optional<HostAndPort> parts = host_and_port(std::string_view(address).substr(protocol.size()));
  if (!parts || (parts->host.empty() && !listens)) {
    return fail(Error::Code::kBadOption, fmt::format("'{}': must be {}HOST:PORT", address, protocol));
  }
  SocketAddress host;
  if (const int error = host.look_up(*parts, is_stream ? SOCK_STREAM : SOCK_DGRAM, AI_PASSIVE)) {
    return look_up_error(address, error);
  }
  return open_socket_at(host, address, kind);
}

Result<Link> Link::open_socket_at(const SocketAddress& host, const std::string& address, Kind kind) {
  const bool listens = kind == Kind::kListeningSocket || kind == Kind::kListeningStream;
  const bool is_stream = kind == Kind::kStream || kind == Kind::kListeningStream;
  const int type = (is_stream ? SOCK_STREAM : SOCK_DGRAM) | SOCK_NONBLOCK | SOCK_CLOEXEC;
  Descriptor socket(::socket(host.bytes.ss_family, type, 0));
  if (!socket.valid()) return os_error(address, errno);
  // Room for what comes while a sweep is mapped; the system may allow less.
  constexpr int kBuffer_bytes = 4 << 20;
  static_cast<void>(::setsockopt(socket.get(), SOL_SOCKET, SO_RCVBUF, &kBuffer_bytes, sizeof kBuffer_bytes));
  // A server that is started again must get its port at once.
  constexpr int kYes = 1;
  if (kind == Kind::kListeningStream) {
    static_cast<void>(::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &kYes, sizeof kYes));
  }
  const int status =
      listens ? ::bind(socket.get(), host.address(), host.size) : ::connect(socket.get(), host.address(), host.size);
  const bool is_connecting = kind == Kind::kStream && errno == EINPROGRESS;
  if (status != 0 && !is_connecting) return os_error(address, errno);
  if (kind == Kind::kListeningStream && ::listen(socket.get(), 1) != 0) return os_error(address, errno);
  const std::string own = listens ? address_of(socket.get(), is_stream ? kTcp : kUdp) : address;
  return Link(kind, own, std::move(socket));
}

Result<Link> Link::open_serial_port(const std::string& address) {
  const Result<SerialPort> serial = serial_port_in(address);
  if (!serial) return tl::unexpected(serial.error());
  Descriptor port(::open(serial->path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!port.valid()) return os_error(serial->path, errno);
  if (const int error = make_raw(port.get(), serial->speed)) return os_error(serial->path, error);
  return Link(Kind::kTerminal, address, std::move(port));
}

Result<Link> Link::open_pseudo_terminal() {
  constexpr std::string_view kName = "pseudo terminal";
  Descriptor device(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  std::array<char, 128> path = {};
  if (!device.valid() || ::grantpt(device.get()) != 0 || ::unlockpt(device.get()) != 0 ||
      ::ptsname_r(device.get(), path.data(), path.size()) != 0) {
    return os_error(kName, errno);
  }
  Descriptor host(::open(path.data(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  if (!host.valid()) return os_error(kName, errno);
  if (const int error = make_raw(host.get(), B115200)) return os_error(kName, error);
  Link link(Kind::kTerminal, path.data(), std::move(device));
  link.other_end_ = std::move(host);
  return link;
}

std::string Link::sender_text() const {
  if (host_.empty()) return {};
  return text_of(reinterpret_cast<const sockaddr*>(host_.data()), static_cast<socklen_t>(host_.size()));
}

/// Of the listening TCP end: the next connection waits until this one ends.
Result<std::size_t> Link::read_connection(std::span<std::uint8_t> to) {
  if (!other_end_.valid())
    other_end_ = Descriptor(::accept4(file_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!other_end_.valid()) return std::size_t{0};
  const ssize_t got = ::recv(other_end_.get(), to.data(), to.size(), 0);
  if (got > 0) return static_cast<std::size_t>(got);
  const bool is_idle = got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR);
  if (!is_idle) other_end_ = Descriptor(-1);
  return std::size_t{0};
}

Result<std::size_t> Link::read(std::span<std::uint8_t> to) {
  if (kind_ == Kind::kListeningStream) return read_connection(to);
  sockaddr_storage sender = {};
  socklen_t size = sizeof sender;
  const ssize_t got = kind_ == Kind::kTerminal ? ::read(file_.get(), to.data(), to.size())
                                               : ::recvfrom(file_.get(), to.data(), to.size(), 0,
                                                            reinterpret_cast<sockaddr*>(&sender), &size);
  if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) return std::size_t{0};
  if (got < 0) return os_error(address_, errno);
  if (got == 0 && (kind_ == Kind::kTerminal || kind_ == Kind::kStream))
    return fail(Error::Code::kIo, fmt::format("{}: hung up", address_));
  if (kind_ == Kind::kListeningSocket) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&sender);
    host_.assign(bytes, bytes + size);
  }
  return static_cast<std::size_t>(got);
}

bool Link::is_connecting() const {
  if (kind_ != Kind::kStream) return false;
  pollfd end = {file_.get(), POLLOUT, 0};
  return ::poll(&end, 1, 0) == 0;
}

Result<void> Link::write(std::span<const std::uint8_t> bytes) {
  // No bytes would be an empty datagram.
  if (bytes.empty() || (kind_ == Kind::kListeningSocket && host_.empty())) return {};
  if (kind_ == Kind::kListeningStream) {
    // A host that has gone is noticed by `read`.
    if (other_end_.valid()) static_cast<void>(::send(other_end_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL));
    return {};
  }
  const auto* host = reinterpret_cast<const sockaddr*>(host_.data());
  const ssize_t sent = kind_ == Kind::kTerminal          ? ::write(file_.get(), bytes.data(), bytes.size())
                       : kind_ != Kind::kListeningSocket ? ::send(file_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL)
                                                         : ::sendto(file_.get(), bytes.data(), bytes.size(), 0, host,
                                                                    static_cast<socklen_t>(host_.size()));
  const bool is_full = errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR || errno == ENOBUFS;
  if (sent < 0 && !is_full) return os_error(address_, errno);
  return {};
}

struct LinkOpening::LookUp {
  std::mutex mutex;
  bool has_ended = false;
  int error = 0;
  Link::SocketAddress host;
};

LinkOpening::LinkOpening(const std::string& address) : address_(address) {
  const bool is_stream = address.starts_with(kTcp);
  if (!is_stream && !address.starts_with(kUdp)) {
    opened_ = Link::open(address);
    return;
  }
  Result<HostAndPort> parts = remote_in(address, is_stream ? kTcp : kUdp);
  if (!parts) {
    opened_ = tl::unexpected(parts.error());
    return;
  }
  const int type = is_stream ? SOCK_STREAM : SOCK_DGRAM;
  if (Link::SocketAddress host; host.look_up(*parts, type, AI_NUMERICHOST) == 0) {
    opened_ = Link::open_socket_at(host, address, is_stream ? Link::Kind::kStream : Link::Kind::kSocket);
    return;
  }
  look_up_ = std::make_shared<LookUp>();
  try {
    std::thread([look_up = look_up_, parts = *std::move(parts), type] {
      Link::SocketAddress host;
      const int error = host.look_up(parts, type, 0);
      const std::scoped_lock lock(look_up->mutex);
      look_up->host = host;
      look_up->error = error;
      look_up->has_ended = true;
    }).detach();
  } catch (const std::system_error& error) {
    look_up_.reset();
    opened_ = fail(Error::Code::kIo, fmt::format("{}: no thread to look it up: {}", address, error.what()));
  }
}

std::optional<Result<Link>> LinkOpening::take() {
  if (!look_up_) return std::exchange(opened_, std::nullopt);
  const std::scoped_lock lock(look_up_->mutex);
  if (!look_up_->has_ended) return std::nullopt;
  if (look_up_->error != 0) return look_up_error(address_, look_up_->error);
  return Link::open_socket_at(look_up_->host, address_,
                              address_.starts_with(kTcp) ? Link::Kind::kStream : Link::Kind::kSocket);
}

}  // namespace pingvox
