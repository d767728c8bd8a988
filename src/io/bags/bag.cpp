#include "io/bags/bag.hpp"

#include <algorithm>
#include <utility>

#include "io/internal/frame_finder.hpp"

namespace pingvox {
namespace {

/// Whether a message is compressed by itself: what is not begins with the zero of plain CDR.
bool is_packed(const BagTopic& topic, std::span<const std::uint8_t> message) {
  return topic.is_readable && topic.encoding == RosEncoding::kCdr && begins_zstd(message);
}

/// The files of one bag, one after the other.
class BagParts final : public Bag {
 public:
  BagParts(std::string name, std::vector<std::string> paths) : name_(std::move(name)), paths_(std::move(paths)) {}

  const std::string& name() const override { return name_; }
  std::optional<double> share_read() const override {
    const double done = static_cast<double>(opened_) - (part_ ? 1.0 - part_->share_read().value_or(0.0) : 0.0);
    return done / static_cast<double>(paths_.size());
  }

 private:
  Result<std::optional<BagMessage>> read() override {
    while (part_ || opened_ < paths_.size()) {
      if (!part_) {
        Result<std::unique_ptr<Bag>> part = ByteStream::open(paths_[opened_]).and_then(open_bag);
        if (!part) return tl::unexpected(part.error());
        part_ = *std::move(part);
        first_topic_ = topics_.size();
        ++opened_;
      }
      Result<std::optional<BagMessage>> message = part_->next();
      if (!message) return message;
      const auto known = static_cast<std::ptrdiff_t>(topics_.size() - first_topic_);
      topics_.insert(topics_.end(), part_->topics().begin() + known, part_->topics().end());
      damage_ = before_;
      for (const DamageKind& kind : part_->damage()) {
        // A position would be one in an unknown file.
        add_damage(damage_, kind.what, std::nullopt);
        std::ranges::find(damage_, kind.what, &DamageKind::what)->count += kind.count - 1;
      }
      if (*message) {
        (*message)->topic += first_topic_;
        (*message)->file_byte.reset();
        return message;
      }
      before_ = damage_;
      part_.reset();
    }
    return std::nullopt;
  }

  std::string name_;
  std::vector<std::string> paths_;
  std::size_t opened_ = 0;
  std::unique_ptr<Bag> part_;
  std::size_t first_topic_ = 0;     ///< of the part
  std::vector<DamageKind> before_;  ///< of the parts before it
};

}  // namespace

Result<std::optional<BagMessage>> Bag::next() {
  for (;;) {
    Result<std::optional<BagMessage>> message = read();
    if (!message || !*message || !is_packed(topics_[(*message)->topic], (*message)->bytes)) return message;
    const Unpacked unpacked = unpack_zstd_frame((*message)->bytes, budget_, unpacked_message_);
    if (unpacked.is_whole) {
      (*message)->bytes = unpacked_message_;
      return message;
    }
    add_damage(damage_, unpacked.is_refused ? kTooLargeUnpacked : "damaged compressed message", (*message)->file_byte);
  }
}

Result<std::unique_ptr<Bag>> open_bag(ByteStream stream) {
  if (!stream.bag_files().empty()) return std::make_unique<BagParts>(stream.name(), stream.bag_files());
  if (looks_like_ros1_bag(stream.beginning())) return open_ros1_bag(std::move(stream));
  if (looks_like_mcap(stream.beginning())) return open_mcap(std::move(stream));
  return open_sqlite_bag(std::move(stream));
}

}  // namespace pingvox
