#include "io/bags/bag_topics.hpp"

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "io/bytes/text.hpp"
#include "io/internal/frame_finder.hpp"
#include "pingvox/nav/receiver_clock.hpp"

namespace pingvox {

std::string_view without_slash(std::string_view frame) {
  while (frame.starts_with('/')) frame.remove_prefix(1);
  return frame;
}

std::optional<double> KnownTopic::stamp_of(const RosMessage& message) const {
  if (!stamp_s || !stamp_ns) return std::nullopt;
  return message.number(*stamp_s) + message.number(*stamp_ns) * 1e-9;
}

double KnownTopic::time_of(const RosMessage& message, double recorded_s) const {
  constexpr double kNear_s = 60.0;
  const std::optional<double> time_s = stamp_of(message);
  if (!time_s) return recorded_s;
  const bool has_date = *time_s >= kFirstDate_s;
  const bool is_near = std::fabs(*time_s - recorded_s) <= kNear_s;
  return is_near || (has_date && recorded_s < kFirstDate_s) ? *time_s : recorded_s;
}

std::optional<KnownTopic> topic_with(const BagTopic& topic, std::span<const std::string_view> paths) {
  // Some writers leave only a part of the definition; a common type has another.
  for (const bool is_common : {false, true}) {
    std::shared_ptr<const RosLayout> layout = is_common ? shared_layout(topic.type, {}, topic.encoding) : topic.layout;
    if (!layout) continue;
    std::vector<std::size_t> fields;
    bool has_all = true;
    for (const std::string_view path : paths) {
      if (path.empty()) break;
      const std::optional<std::size_t> field = layout->field(path);
      has_all = has_all && field;
      fields.push_back(field.value_or(0));
    }
    if (!has_all) continue;
    // The last one is that of Foxglove's messages.
    std::optional<std::size_t> stamp_s, stamp_ns;
    for (const std::string stamp : {"header.stamp.", "transforms.header.stamp.", "timestamp."}) {
      if (stamp_s && stamp_ns) break;
      stamp_s = layout->field(stamp + "sec");
      stamp_ns = layout->field(stamp + "nanosec");
      if (!stamp_ns) stamp_ns = layout->field(stamp + "nsec");
    }
    const auto frame = layout->field("header.frame_id"), child = layout->field("child_frame_id");
    return KnownTopic{0, std::move(layout), std::move(fields), stamp_s, stamp_ns, frame, child};
  }
  return std::nullopt;
}

void UnusableMessages::add(const Unusable& message, std::optional<std::uint64_t> file_byte) {
  add_damage(kinds_, message.kind, file_byte);
  if (!first_text_.empty()) return;
  first_text_ = message.why.empty()
                    ? first_damage_text(kinds_.front())
                    : fmt::format("{}{}", file_byte ? fmt::format("byte {}: ", *file_byte) : "", message.why);
}

std::vector<DamageKind> damage_of(const Bag& bag, const UnusableMessages& unusable) {
  std::vector<DamageKind> kinds = bag.damage();
  kinds.insert(kinds.end(), unusable.kinds().begin(), unusable.kinds().end());
  return kinds;
}

std::string first_damage_of(const Bag& bag, const UnusableMessages& unusable) {
  return bag.damage().empty() ? unusable.first_text() : first_damage_text(bag.damage().front());
}

std::string topics_text(const Bag& bag, bool (*is_of_kind)(const BagTopic&)) {
  std::set<std::string> names;
  for (const BagTopic& topic : bag.topics()) {
    if (is_of_kind(topic)) names.insert(in_ascii(fmt::format("{} ({})", topic.name, topic.type)));
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

tl::unexpected<Error> several_topics(const Bag& bag, std::string_view what, bool (*is_of_kind)(const BagTopic&)) {
  return fail(Error::Code::kBadOption, fmt::format("{}: holds several topics with {}: {}: choose one with --topic",
                                                   bag.name(), what, topics_text(bag, is_of_kind)));
}

std::string note_of_stamps(std::string_view topic) {
  return fmt::format(
      "the stamps of {} do not change while its messages are recorded: their times are those of the "
      "recording",
      in_ascii(topic));
}

std::string joined_notes(std::string one, const std::string& other) {
  if (!one.empty() && !other.empty()) one += "; ";
  return one + other;
}

}  // namespace pingvox
