#include "pingvox/live/live_options.hpp"

#include <fmt/format.h>

#include <string_view>

#include "base/option_errors.hpp"
#include "device/internal/link.hpp"

namespace pingvox {

std::string LiveHead::name() const {
  switch (kind) {
    case Kind::kPing360:
      return "ping360:" + address;
    case Kind::kMicron:
      return "micron:" + address;
    case Kind::kReplay:
      break;
  }
  return "replay:" + address;
}

Result<void> LiveHead::validate() const {
  OptionErrors errors;
  if (kind == Kind::kReplay) {
    errors.require(speed > 0.0, "speed", "> 0", speed);
    errors.require(!address.empty(), "address", "a file", "empty");
  } else {
    errors.add(Link::check(address));
    errors.add(kind == Kind::kMicron ? micron.validate() : ping360.validate());
  }
  return errors.result("head");
}

Result<void> LiveNav::validate() const {
  OptionErrors errors;
  if (kind == Kind::kA50) {
    errors.require(address.starts_with("tcp://"), "address", "tcp://HOST:PORT", address);
    if (address.starts_with("tcp://")) errors.add(Link::check(address));
  } else {
    errors.require(address.starts_with("udp://"), "address", "udp://:PORT or udp://ADDRESS:PORT", address);
  }
  return errors.result("nav");
}

Result<void> LiveOptions::validate() const {
  OptionErrors errors;
  errors.add(head.validate());
  for (const LiveNav& device : nav) errors.add(device.validate());
  if (head.kind == LiveHead::Kind::kReplay) {
    if (record) errors.add("record: a replay is a recording already");
    if (!nav.empty()) errors.add("nav: the poses of a replay are of another time");
  }
  for (const std::string_view suffix : {".tlog", ".jsonl"}) {
    if (record && !nav.empty() && record->ends_with(suffix)) {
      errors.add(fmt::format("record: {} is the suffix of a recording of navigation", suffix));
    }
  }
  if (obstacles) {
    errors.require(obstacles->starts_with("udp://"), "obstacles", "udp://HOST:PORT", *obstacles);
    if (obstacles->starts_with("udp://")) errors.add(Link::check(*obstacles));
  }
  if (slam) errors.add(slam->validate());
  errors.add(map.validate());
  errors.add(build.validate());
  return errors.result("live");
}

}  // namespace pingvox
