#include "io/internal/frame_finder.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>

namespace pingvox {

std::uint16_t PrefixSums::sum(std::span<const std::uint8_t> bytes, std::size_t from, std::size_t to) {
  assert(from <= to && to <= bytes.size());
  while (sums_.size() <= to) sums_.push_back(static_cast<std::uint16_t>(sums_.back() + bytes[sums_.size() - 1]));
  return static_cast<std::uint16_t>(sums_[to] - sums_[from]);
}

std::uint16_t FrameBytes::sum(std::size_t size) const {
  if (sums != nullptr) return sums->sum(stream, start, start + size);
  const std::span<const std::uint8_t> summed = stream.subspan(start, size);
  return static_cast<std::uint16_t>(std::accumulate(summed.begin(), summed.end(), 0U));
}

void FrameFinder::push(std::span<const std::uint8_t> bytes) {
  bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(start_));
  start_ = 0;
  sums_.clear();
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

std::optional<FrameFinder::Frame> FrameFinder::next() {
  while (start_ < bytes_.size()) {
    const std::span<const std::uint8_t> all(bytes_), rest = all.subspan(start_);
    FrameCheck check = check_({all, start_, in_damage_ ? &sums_ : nullptr});
    if (check.verdict == FrameCheck::Verdict::kIncomplete) {
      if (!ended_) return std::nullopt;
      check = {FrameCheck::Verdict::kBroken, rest.size(), kCutOff};
    }
    assert(check.size > 0 && check.size <= rest.size());
    if (check.verdict == FrameCheck::Verdict::kFrame) {
      const Frame frame{position_, rest.first(check.size)};
      start_ += check.size;
      position_ += check.size;
      in_damage_ = false;
      between_from_.reset();
      broken_until_ = 0;
      return frame;
    }
    pass(check);
  }
  return std::nullopt;
}

void FrameFinder::pass(const FrameCheck& check) {
  if (check.verdict == FrameCheck::Verdict::kBroken) {
    // What looks like a frame within a broken one is part of its damage.
    if (position_ >= broken_until_) add_damage(damage_, check.why, position_);
    broken_until_ = std::max(broken_until_, position_ + check.size);
    between_from_.reset();
  } else if (!in_damage_) {
    between_from_ = position_;
  }
  in_damage_ = true;
  const std::size_t passed = check.verdict == FrameCheck::Verdict::kBroken ? 1 : check.size;
  start_ += passed;
  position_ += passed;
  if (between_from_ && position_ - *between_from_ >= least_between_) {
    add_damage(damage_, kBetween, between_from_);
    between_from_.reset();
  }
}

void add_damage(std::vector<DamageKind>& kinds, std::string_view what, std::optional<std::uint64_t> at_byte) {
  const auto known = std::ranges::find(kinds, what, &DamageKind::what);
  if (known != kinds.end()) {
    ++known->count;
  } else {
    kinds.push_back({what, 1, at_byte});
  }
}

}  // namespace pingvox
