#include "io/beams/frame_log.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <deque>
#include <utility>

#include "io/beams/device_log.hpp"
#include "io/beams/stream_reader.hpp"
#include "io/internal/ping_frame.hpp"
#include "io/internal/seanet_frame.hpp"

namespace pingvox {
namespace {

const DeviceProfile* ping_device_of(std::span<const std::uint8_t>) {
  return find_device("ping360");
}

const DeviceProfile* seanet_device_of(std::span<const std::uint8_t> frame) {
  const auto line = seanet_line(frame);
  return line ? device_of(*line) : nullptr;
}

/// By the device that sent the frame.
unsigned ping_head_of(std::span<const std::uint8_t> frame) {
  constexpr std::size_t kSource = 6;
  return frame[kSource];
}

unsigned seanet_head_of(std::span<const std::uint8_t> frame) {
  return static_cast<unsigned>(seanet_sender(frame));
}

/// Kinds in the order of their first occurrences, each once. An end that cuts off a record and the frame in it counts
/// once.
std::vector<DamageKind> merge_damage(const std::vector<DamageKind>& kinds) {
  std::vector<DamageKind> merged;
  for (const DamageKind& kind : kinds) {
    const auto same = std::ranges::find(merged, kind.what, &DamageKind::what);
    if (same == merged.end()) {
      merged.push_back(kind);
      continue;
    }
    if (kind.what != FrameFinder::kCutOff) same->count += kind.count;
    same->first_byte = std::min(same->first_byte, kind.first_byte);
  }
  std::vector<DamageKind> in_order;
  for (const DamageKind& kind : merged) {
    in_order.insert(std::ranges::upper_bound(in_order, kind.first_byte, {}, &DamageKind::first_byte), kind);
  }
  return in_order;
}

/// Maps positions of the byte stream to positions in the file and times.
class PlacesInFile {
 public:
  void add(const FrameContainer::Piece& piece) {
    if (piece.bytes.empty()) return;
    pieces_.push_back({end_, piece});
    end_ += piece.bytes.size();
  }
  /// Drops pieces before a position.
  void forget_before(std::uint64_t place) {
    while (pieces_.size() > 1 && pieces_[1].from <= place) pieces_.pop_front();
  }
  std::uint64_t file_byte(std::uint64_t place) const {
    const Known* known = piece_at(place);
    return known == nullptr ? 0 : known->piece.file_byte + (place - known->from) * known->piece.file_step;
  }
  double time_s(std::uint64_t place) const {
    const Known* known = piece_at(place);
    if (known == nullptr) return 0.0;
    return known->piece.time_s + static_cast<double>(place - known->from) * known->piece.time_step_s;
  }

 private:
  struct Known {
    std::uint64_t from;
    FrameContainer::Piece piece;
  };
  const Known* piece_at(std::uint64_t place) const {
    const Known* last = nullptr;
    for (const Known& known : pieces_) {
      if (known.from > place) break;
      last = &known;
    }
    return last;
  }

  std::deque<Known> pieces_;
  std::uint64_t end_ = 0;
};

class RawCapture final : public FrameContainer {
 public:
  explicit RawCapture(StreamReader reader) : reader_(std::move(reader)) {}

  const std::string& name() const override { return reader_.name(); }
  std::optional<double> share_read() const override { return reader_.share_read(); }
  BeamClock clock() const override { return BeamClock::kNone; }

  Result<std::optional<Piece>> next() override {
    constexpr std::size_t kAtOnce = std::size_t{1} << 16;
    const Result<std::span<const std::uint8_t>> bytes = reader_.peek(kAtOnce);
    if (!bytes) return tl::unexpected(bytes.error());
    if (bytes->empty()) return std::nullopt;
    const std::uint64_t at = reader_.position();
    reader_.skip(bytes->size());
    return Piece{*bytes, at, 1, static_cast<double>(at + 1) * kSerialByte_s, kSerialByte_s};
  }

 private:
  StreamReader reader_;
};

class FrameLog final : public DeviceLog {
 public:
  FrameLog(std::unique_ptr<FrameContainer> container, const FrameProtocol& protocol, Damage damage)
      : container_(std::move(container)),
        protocol_(protocol),
        damage_(damage),
        finder_(protocol.check, protocol.least_between) {
    set_first(read());
  }

  std::vector<DamageKind> damage() const override {
    std::vector<DamageKind> kinds = container_->damage();
    for (std::size_t i = 0; i < finder_.damage().size(); ++i) {
      DamageKind kind = finder_.damage()[i];
      kind.first_byte = first_bytes_[i];
      kinds.push_back(kind);
    }
    kinds.insert(kinds.end(), unusable_.begin(), unusable_.end());
    return merge_damage(kinds);
  }

  std::optional<double> share_read() const override { return container_->share_read(); }
  BeamClock clock() const override { return container_->clock(); }

 private:
  Result<std::optional<Beam>> read() override {
    for (;;) {
      const std::optional<FrameFinder::Frame> frame = finder_.next();
      note_places();
      if (const auto whole = check_damage(); !whole) return tl::unexpected(whole.error());
      if (!frame) {
        if (at_end_) return std::nullopt;
        if (const auto more = push_more(); !more) return tl::unexpected(more.error());
        continue;
      }
      auto beam = protocol_.beam_in(frame->bytes, places_.time_s(frame->end() - 1));
      if (!beam) {
        add_damage(unusable_, damage_kind_of(beam.error()), places_.file_byte(frame->at));
        if (damage_ == Damage::kFail) return damage_error({beam.error(), 1, unusable_.front().first_byte});
      } else if (*beam && !is_of_first_head(protocol_.head_of(frame->bytes))) {
        add_damage(unusable_, kOtherHead, places_.file_byte(frame->at));
        if (damage_ == Damage::kFail) return damage_error({kOtherHead, 1, places_.file_byte(frame->at)});
      } else if (*beam) {
        if (device_ == nullptr) device_ = protocol_.device_of(frame->bytes);
        places_.forget_before(frame->end());
        return std::move(*beam);
      }
      places_.forget_before(frame->end());
    }
  }

  Result<void> push_more() {
    const Result<std::optional<FrameContainer::Piece>> piece = container_->next();
    if (!piece) return tl::unexpected(piece.error());
    if (*piece) {
      places_.forget_before(finder_.settled());
      places_.add(**piece);
      finder_.push((*piece)->bytes);
    } else {
      at_end_ = true;
      finder_.end();
    }
    return {};
  }

  /// Stores positions in the file before the pieces are dropped.
  void note_places() {
    for (std::size_t i = first_bytes_.size(); i < finder_.damage().size(); ++i) {
      first_bytes_.push_back(places_.file_byte(*finder_.damage()[i].first_byte));
    }
  }

  Result<void> check_damage() const {
    if (damage_ == Damage::kSkip || (container_->damage().empty() && first_bytes_.empty())) return {};
    return damage_error(damage().front());
  }

  tl::unexpected<Error> damage_error(const DamageKind& kind) const {
    return fail(Error::Code::kCorrupt, fmt::format("{}: {}", container_->name(), first_damage_text(kind)));
  }

  std::unique_ptr<FrameContainer> container_;
  const FrameProtocol& protocol_;
  Damage damage_;
  FrameFinder finder_;
  PlacesInFile places_;
  bool at_end_ = false;
  std::vector<std::uint64_t> first_bytes_;  ///< positions in the file of the finder's damage
  std::vector<DamageKind> unusable_;        ///< valid frames with invalid values
};

}  // namespace

const FrameProtocol& ping_protocol() {
  static constexpr FrameProtocol kPing = {check_ping_frame, ping_beam_in, ping_device_of, ping_head_of, kMinPingFrame};
  return kPing;
}

const FrameProtocol& sonarview_protocol() {
  static constexpr FrameProtocol kSonarView = {check_sonarview_frame, ping_beam_in, ping_device_of, ping_head_of};
  return kSonarView;
}

const FrameProtocol& seanet_protocol() {
  static constexpr FrameProtocol kSeanet = {check_seanet_frame, seanet_beam_in, seanet_device_of, seanet_head_of};
  return kSeanet;
}

std::unique_ptr<FrameContainer> raw_capture(ByteStream stream) {
  return std::make_unique<RawCapture>(StreamReader(std::move(stream)));
}

std::unique_ptr<BeamSource> beams_of(std::unique_ptr<FrameContainer> container, const FrameProtocol& protocol,
                                     Damage damage) {
  return std::make_unique<FrameLog>(std::move(container), protocol, damage);
}

}  // namespace pingvox
