#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "io/internal/descriptor.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// A connection to a device, or the end of the device. Only opening it may block, to look up a host's name; see
/// LinkOpening.
class Link {
 public:
  /// Opens the host's end.
  /// @param address  "udp://HOST:PORT", "tcp://HOST:PORT", or a serial port, "/dev/ttyUSB0" or "/dev/ttyUSB0@57600"
  ///                 (115200 baud, 8N1). A TCP connection that cannot be made is an error of `read`.
  /// @return kBadOption when it is none of these, kIo when it cannot be opened
  static Result<Link> open(const std::string& address);
  /// Whether `open` can take the address at all. @return kBadOption when it cannot
  static Result<void> check(const std::string& address);
  /// Opens the end that waits for the other one: an emulator's, or that of a host to which a vehicle sends.
  /// @param address  "udp://HOST:PORT" (no host: all addresses of this one; port 0: one that is free),
  /// "tcp://HOST:PORT"
  ///                 likewise, for one connection at a time, or "pty" for a new pseudo terminal
  static Result<Link> listen(const std::string& address);

  /// Address to open the other end: with the port that was chosen, or the path of the terminal.
  const std::string& address() const { return address_; }
  /// Of a listening UDP end: socket address of the last datagram's sender; empty: nothing came so far.
  const std::vector<std::uint8_t>& sender() const { return host_; }
  /// The same as "192.168.2.2:14550".
  std::string sender_text() const;
  /// For poll().
  int descriptor() const {
    return kind_ == Kind::kListeningStream && other_end_.valid() ? other_end_.get() : file_.get();
  }

  /// Whether a TCP connection is not made yet, so that what is written would be lost.
  bool is_connecting() const;
  /// Reads what has arrived, of datagrams one.
  /// @return 0: nothing; kIo when the line is lost
  Result<std::size_t> read(std::span<std::uint8_t> to);
  /// Sends bytes; those that the line does not accept now are lost. A listening end sends nothing before the host sent
  /// anything (UDP) or connected (TCP). @return kIo when the line is lost
  Result<void> write(std::span<const std::uint8_t> bytes);

 private:
  friend class LinkOpening;
  struct SocketAddress;
  enum class Kind { kSocket, kListeningSocket, kStream, kListeningStream, kTerminal };
  Link(Kind kind, std::string address, Descriptor file)
      : kind_(kind), address_(std::move(address)), file_(std::move(file)) {}
  static Result<Link> open_socket(const std::string& address, Kind kind);
  static Result<Link> open_socket_at(const SocketAddress& host, const std::string& address, Kind kind);
  static Result<Link> open_serial_port(const std::string& address);
  static Result<Link> open_pseudo_terminal();
  Result<std::size_t> read_connection(std::span<std::uint8_t> to);

  Kind kind_;
  std::string address_;
  Descriptor file_;
  /// Of a pseudo terminal, which hangs up when nobody has it open; of a listening TCP end the connection.
  Descriptor other_end_{-1};
  std::vector<std::uint8_t> host_ = {};  ///< socket address of the last datagram's sender
};

/// Opens the host's end of a connection without waiting for a name server: a host's name is looked up by a thread of
/// its own, which outlives this value where no server answers.
class LinkOpening {
 public:
  /// Begins to open what `Link::open` opens.
  explicit LinkOpening(const std::string& address);

  /// What `Link::open` returns, once; nullopt: the name is still being looked up.
  std::optional<Result<Link>> take();

 private:
  struct LookUp;

  std::string address_;
  std::optional<Result<Link>> opened_;  ///< of an address without a name
  std::shared_ptr<LookUp> look_up_;     ///< shared with its thread; nullptr: none
};

}  // namespace pingvox
