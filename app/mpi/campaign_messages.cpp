#include "campaign_messages.hpp"

#include <cassert>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <type_traits>

namespace pingvox::app {
namespace {

class Packer {
 public:
  template <class Number>
  void put(Number number) {
    static_assert(std::is_arithmetic_v<Number>);
    const std::size_t at = bytes_.size();
    bytes_.resize(at + sizeof number);
    std::memcpy(bytes_.data() + at, &number, sizeof number);
  }
  void put(const std::string& text) {
    put(std::uint64_t{text.size()});
    bytes_ += text;
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class Unpacker {
 public:
  explicit Unpacker(std::string_view bytes) : bytes_(bytes) {}

  template <class Number>
  Number number() {
    assert(bytes_.size() >= sizeof(Number));
    Number number{};
    std::memcpy(&number, bytes_.data(), sizeof number);
    bytes_.remove_prefix(sizeof number);
    return number;
  }
  std::uint64_t count() { return number<std::uint64_t>(); }
  std::string text() {
    const std::uint64_t size = count();
    std::string text(bytes_.substr(0, size));
    bytes_.remove_prefix(size);
    return text;
  }

 private:
  std::string_view bytes_;
};

}  // namespace

std::string bytes_of(const Campaign& campaign) {
  Packer out;
  out.put(campaign.forecast.resolution_m);
  out.put(campaign.origin.has_value());
  if (campaign.origin) {
    for (const double number : campaign.origin->fix) out.put(number);
    out.put(campaign.origin->heights == MapOrigin::Heights::kAboveFix);
  }
  out.put(std::uint64_t{campaign.dives.size()});
  for (const Dive& dive : campaign.dives) {
    out.put(dive.name);
    out.put(dive.log);
    out.put(std::uint64_t{dive.navs.size()});
    for (const std::string& nav : dive.navs) out.put(nav);
    out.put(dive.nav_offset_s.has_value());
    out.put(dive.nav_offset_s.value_or(0.0));
    out.put(dive.bytes);
  }
  return out.take();
}

Campaign campaign_from(const std::string& bytes) {
  Unpacker in(bytes);
  Campaign campaign;
  campaign.forecast.resolution_m = in.number<double>();
  if (in.number<bool>()) {
    MapOrigin& origin = campaign.origin.emplace();
    for (double& number : origin.fix) number = in.number<double>();
    origin.heights = in.number<bool>() ? MapOrigin::Heights::kAboveFix : MapOrigin::Heights::kOwn;
  }
  campaign.dives.resize(in.count());
  for (Dive& dive : campaign.dives) {
    dive.name = in.text();
    dive.log = in.text();
    dive.navs.resize(in.count());
    for (std::string& nav : dive.navs) nav = in.text();
    const bool has_offset = in.number<bool>();
    const double offset_s = in.number<double>();
    if (has_offset) dive.nav_offset_s = offset_s;
    dive.bytes = in.count();
  }
  return campaign;
}

std::string bytes_of(const std::map<std::size_t, DiveOutcome>& outcomes) {
  Packer out;
  out.put(std::uint64_t{outcomes.size()});
  for (const auto& [number, outcome] : outcomes) {
    out.put(std::uint64_t{number});
    out.put(outcome.beams);
    out.put(outcome.echoes);
    out.put(outcome.no_pose);
    out.put(outcome.outside);
    out.put(static_cast<int>(outcome.axes));
    out.put(outcome.was_kept);
    out.put(outcome.left_out);
  }
  return out.take();
}

std::map<std::size_t, DiveOutcome> outcomes_from(const std::string& bytes) {
  Unpacker in(bytes);
  std::map<std::size_t, DiveOutcome> outcomes;
  for (std::uint64_t left = in.count(); left > 0; --left) {
    DiveOutcome& outcome = outcomes[in.count()];
    outcome.beams = in.count();
    outcome.echoes = in.count();
    outcome.no_pose = in.count();
    outcome.outside = in.count();
    outcome.axes = static_cast<MapAxes>(in.number<int>());
    outcome.was_kept = in.number<bool>();
    outcome.left_out = in.text();
  }
  return outcomes;
}

}  // namespace pingvox::app
