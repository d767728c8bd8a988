#include "device/internal/mavlink_receiver.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>

#include "device/read_limit.hpp"

namespace pingvox {
namespace {

constexpr double kVehicleSilence_s = 5.0;

}  // namespace

Result<MavlinkReceiver> MavlinkReceiver::listen(const std::string& address, std::optional<TlogRecorder> recorder,
                                                double since_1970_s) {
  if (!address.starts_with("udp://")) {
    return fail(Error::Code::kBadOption, fmt::format("'{}': must be udp://:PORT or udp://ADDRESS:PORT", address));
  }
  Result<Link> link = Link::listen(address);
  if (!link) return tl::unexpected(link.error());
  return MavlinkReceiver(*std::move(link), std::move(recorder), since_1970_s);
}

Result<std::vector<MavlinkNav::Report>> MavlinkReceiver::read(double now_s) {
  std::vector<MavlinkNav::Report> reports;
  std::array<std::uint8_t, 65536> bytes;
  for (ReadLimit limit; limit.allows_more();) {
    const Result<std::size_t> got = link_.read(bytes);
    limit.count(got.value_or(0));
    if (!got) return tl::unexpected(got.error());
    if (*got == 0) break;
    take(std::span(bytes).first(*got), now_s, reports);
  }
  recorder_.sync_if_due(now_s);
  status_.recording_error = recorder_.error();
  return reports;
}

/// A datagram holds whole frames, one behind the other.
void MavlinkReceiver::take(std::span<const std::uint8_t> datagram, double now_s,
                           std::vector<MavlinkNav::Report>& reports) {
  using Check = MavlinkFrame::Check;
  while (!datagram.empty()) {
    const MavlinkRead read = read_mavlink(datagram);
    if (!read.frame || read.frame->check == Check::kWrong) {
      ++status_.damaged;
      return;
    }
    const std::span<const std::uint8_t> frame = datagram.first(read.length);
    datagram = datagram.subspan(read.length);
    if (!is_followed(*read.frame, now_s)) {
      ++status_.ignored;
      continue;
    }
    constexpr double kUs = 1e6;
    recorder_.append(static_cast<std::uint64_t>((since_1970_s_ + now_s) * kUs), frame);
    if (read.frame->check == Check::kUnknownMessage) continue;
    ++status_.frames;
    if (!vehicle_) continue;
    std::vector<MavlinkNav::Report> said = nav_.add(*read.frame, now_s);
    reports.insert(reports.end(), std::make_move_iterator(said.begin()), std::make_move_iterator(said.end()));
  }
}

/// Whether a frame is of the vehicle that is followed, or comes with it. Chooses the vehicle.
bool MavlinkReceiver::is_followed(const MavlinkFrame& frame, double now_s) {
  const bool is_of_vehicle = MavlinkNav::is_of_vehicle(frame);
  if (!vehicle_ && !is_of_vehicle) return true;  // nothing else identifies it
  if (vehicle_ && vehicle_->address == link_.sender()) {
    if (vehicle_->system == frame.system && is_of_vehicle) vehicle_->last_s = now_s;
    if (vehicle_->system == frame.system || MavlinkNav::is_ground_station(frame)) return true;
  }
  if (!is_of_vehicle) return false;
  const Sender* const sender = other(frame, now_s);
  if (sender == nullptr) return false;
  // A sender that was active beside the vehicle is another one.
  const bool is_next =
      !vehicle_ || (now_s - vehicle_->last_s > kVehicleSilence_s && sender->first_s > vehicle_->last_s);
  if (!is_next) return false;
  vehicle_ = *sender;
  others_.erase(others_.begin() + (sender - others_.data()));
  status_.vehicle = sender_text(frame.system);
  std::erase(status_.others, status_.vehicle);
  ++status_.vehicles;
  return true;
}

/// The sender of a frame among those that are not followed. nullptr: there are too many.
MavlinkReceiver::Sender* MavlinkReceiver::other(const MavlinkFrame& frame, double now_s) {
  constexpr std::size_t kMaxOthers = 16;
  auto sender = std::ranges::find_if(
      others_, [&](const Sender& one) { return one.system == frame.system && one.address == link_.sender(); });
  if (sender == others_.end()) {
    const auto oldest = std::ranges::min_element(others_, {}, &Sender::last_s);
    if (others_.size() == kMaxOthers && now_s - oldest->last_s <= kVehicleSilence_s) return nullptr;
    if (others_.size() == kMaxOthers) others_.erase(oldest);
    others_.push_back({link_.sender(), frame.system, now_s, now_s});
    sender = others_.end() - 1;
    const std::string text = sender_text(frame.system);
    const bool is_new = std::ranges::find(status_.others, text) == status_.others.end();
    if (is_new && status_.others.size() < kMaxOthers) status_.others.push_back(text);
  }
  sender->last_s = now_s;
  return &*sender;
}

std::string MavlinkReceiver::sender_text(std::uint8_t system) const {
  return fmt::format("{} (system {})", link_.sender_text(), system);
}

}  // namespace pingvox
