#include "web/hosts.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <system_error>

namespace pingvox::web {
namespace {

bool is_numeric(std::string_view host) {
  return !host.empty() && std::ranges::all_of(host, [](char c) { return (c >= '0' && c <= '9') || c == '.'; });
}

bool is_address(std::string_view host) {
  return host.starts_with('[') ? host.ends_with(']') : is_numeric(host);
}

/// "localhost:8080": a host and its port, that of HTTP where none is named.
struct HostAndPort {
  std::string_view name;
  int port = 80;
};

std::optional<HostAndPort> host_and_port(std::string_view host) {
  const std::size_t colon = host.rfind(':');
  if (colon == std::string_view::npos || host.find(']', colon) != std::string_view::npos) return HostAndPort{host};
  const std::string_view digits = host.substr(colon + 1);
  std::uint16_t port = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
  if (digits.empty() || error != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
  return HostAndPort{host.substr(0, colon), port};
}

/// Whether an IPv4 address is one of private networks, or of this machine.
bool is_private_address(const std::string& address) {
  struct Network {
    std::uint32_t address;
    int bits;
  };
  // RFC 1918, 1122, 3927 and 6598; the last one is also that of VPNs.
  static constexpr std::array kNetworks = {Network{0x0a000000, 8}, Network{0xac100000, 12}, Network{0xc0a80000, 16},
                                           Network{0x7f000000, 8}, Network{0xa9fe0000, 16}, Network{0x64400000, 10}};
  in_addr parsed{};
  if (::inet_pton(AF_INET, address.c_str(), &parsed) != 1) return false;
  const std::uint32_t number = ntohl(parsed.s_addr);
  return std::ranges::any_of(kNetworks, [&](const Network& network) {
    constexpr int kBits = 32;
    return (number ^ network.address) >> (kBits - network.bits) == 0;
  });
}

/// Whether a host is of a local network: a name without a dot or of multicast DNS, which no page of the Internet has,
/// or a private address.
bool is_local_host(std::string_view host) {
  if (host.starts_with("[fe80:") || host.starts_with("[fd") || host.starts_with("[fc")) return host.ends_with(']');
  const bool is_name = std::ranges::all_of(host, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' ||
           c == '.';
  });
  if (host.empty() || !is_name) return false;
  if (is_numeric(host)) return is_private_address(std::string(host));
  return host.find('.') == std::string_view::npos || host.ends_with(".local");
}

}  // namespace

bool is_own_host(std::string_view host, const Access& access) {
  const std::optional<HostAndPort> named = host_and_port(host);
  if (!named) return false;
  // The proxy of the vehicle forwards the requested host without a port.
  if (access.readers == Readers::kLocalNetwork && is_local_host(named->name)) return true;
  if (named->port != access.port) return false;
  return std::ranges::find(access.hosts, named->name) != access.hosts.end() ||
         (access.any_address && is_address(named->name));
}

int port_of_host(std::string_view host) {
  const std::optional<HostAndPort> named = host_and_port(host);
  return named ? named->port : -1;
}

}  // namespace pingvox::web
