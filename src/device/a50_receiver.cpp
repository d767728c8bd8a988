#include "device/internal/a50_receiver.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <utility>

#include "device/read_limit.hpp"

namespace pingvox {

Result<A50Receiver> A50Receiver::make(const std::string& address, std::optional<RecordFile> recorder,
                                      double since_1970_s) {
  if (!address.starts_with("tcp://")) {
    return fail(Error::Code::kBadOption, fmt::format("'{}': must be tcp://HOST:PORT", address));
  }
  return A50Receiver(address, std::move(recorder), since_1970_s);
}

A50Receiver::A50Receiver(std::string address, std::optional<RecordFile> recorder, double since_1970_s)
    : address_(std::move(address)), recorder_(std::move(recorder)), since_1970_s_(since_1970_s) {}

std::vector<NavSource> A50Receiver::read(double now_s) {
  // The DVL reports at least twice a second.
  constexpr double kSilence_s = 5.0;
  std::vector<NavSource> samples;
  if (!link_ && (!open_at_s_ || now_s >= *open_at_s_)) open(now_s);
  std::array<std::uint8_t, 65536> bytes;
  for (ReadLimit limit; link_ && limit.allows_more();) {
    const Result<std::size_t> got = link_->read(bytes);
    limit.count(got.value_or(0));
    if (!got) {
      close(got.error().message, now_s);
    } else if (*got == 0) {
      break;
    } else {
      take(std::span(bytes).first(*got), now_s, samples);
    }
  }
  if (link_ && now_s - heard_s_ > kSilence_s) close(fmt::format("{}: silent", address_), now_s);
  recorder_.sync_if_due(now_s);
  status_.recording_error = recorder_.error();
  return samples;
}

void A50Receiver::open(double now_s) {
  if (!opening_) opening_.emplace(address_);
  std::optional<Result<Link>> link = opening_->take();
  if (!link) return;
  opening_.reset();
  if (!*link) return close(link->error().message, now_s);
  link_ = *std::move(*link);
  heard_s_ = now_s;
}

void A50Receiver::close(std::string problem, double now_s) {
  constexpr double kMaxDelay_s = 10.0;
  status_.problem = std::move(problem);
  status_.is_connected = false;
  if (!line_.empty()) ++status_.damaged;
  line_.clear();
  link_.reset();
  open_at_s_ = now_s + delay_s_;
  delay_s_ = std::min(2.0 * delay_s_, kMaxDelay_s);
}

/// Lines end with LF, CR or both.
void A50Receiver::take(std::span<const std::uint8_t> bytes, double now_s, std::vector<NavSource>& samples) {
  constexpr std::size_t kMaxLine = 65'536;
  heard_s_ = now_s;
  for (const std::uint8_t byte : bytes) {
    const bool is_end = byte == '\n' || byte == '\r' || line_.size() == kMaxLine;
    if (!is_end) line_.push_back(static_cast<char>(byte));
    if (is_end && !line_.empty()) take_line(std::exchange(line_, {}), now_s, samples);
  }
}

void A50Receiver::take_line(const std::string& line, double now_s, std::vector<NavSource>& samples) {
  const std::string record = with_timestamp(line, since_1970_s_ + now_s) + "\n";
  recorder_.append(std::vector<std::uint8_t>(record.begin(), record.end()));
  std::optional<std::vector<NavSource>> said = nav_.add(line, now_s);
  if (!said) {
    ++status_.damaged;
    return;
  }
  ++status_.reports;
  if (!std::exchange(status_.is_connected, true)) ++status_.connections;
  delay_s_ = kFirstDelay_s;
  samples.insert(samples.end(), std::make_move_iterator(said->begin()), std::make_move_iterator(said->end()));
}

}  // namespace pingvox
