#include "pingvox/device/mavlink_receiver.hpp"

#include <fmt/core.h>

#include <array>
#include <cstdint>
#include <iterator>

namespace pingvox {

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
  // Bounded, so that a sender that never falls silent leaves time for the rest.
  constexpr int kMaxReads = 64;
  std::vector<MavlinkNav::Report> reports;
  std::array<std::uint8_t, 65536> bytes;
  for (int i = 0; i < kMaxReads; ++i) {
    const Result<std::size_t> got = link_.read(bytes);
    if (!got) return tl::unexpected(got.error());
    if (*got == 0) break;
    take(std::span(bytes).first(*got), now_s, reports);
  }
  if (recorder_) recorder_->sync_if_due(now_s);
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
    record(datagram.first(read.length), now_s);
    datagram = datagram.subspan(read.length);
    if (read.frame->check == Check::kUnknownMessage) continue;
    ++status_.frames;
    std::vector<MavlinkNav::Report> said = nav_.add(*read.frame, now_s);
    reports.insert(reports.end(), std::make_move_iterator(said.begin()), std::make_move_iterator(said.end()));
  }
}

void MavlinkReceiver::record(std::span<const std::uint8_t> frame, double now_s) {
  if (!recorder_) return;
  constexpr double kUs = 1e6;
  const auto time_us = static_cast<std::uint64_t>((since_1970_s_ + now_s) * kUs);
  if (const auto recorded = recorder_->append(time_us, frame); !recorded) {
    status_.recording_error = recorded.error();
    recorder_.reset();
  }
}

}  // namespace pingvox
