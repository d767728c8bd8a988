#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "io/bytes/text.hpp"
#include "io/internal/frame_finder.hpp"
#include "io/nav/nav_readers.hpp"
#include "io/nav/nav_sources.hpp"
#include "pingvox/geometry/degree.hpp"

// NMEA 0183 as it is logged (docs/formats.md): sentences between other text.
namespace pingvox {
namespace {

constexpr double kMetresPerSecondOfKnot = 1852.0 / 3600.0, kDay_s = 86'400.0;

/// A sentence with a right checksum, or of a device that sends none.
class Sentence {
 public:
  explicit Sentence(std::string_view body) {
    constexpr std::size_t kMaxFields = 64;
    while (fields_.size() < kMaxFields) {
      const auto field = cut_field(body, ',');
      if (!field) break;
      fields_.push_back(*field);
    }
  }

  /// Talker and type, as in "GPRMC".
  std::string_view address() const { return fields_.front(); }
  bool is(std::string_view type) const { return address().size() == 5 && address().ends_with(type); }
  /// Counted from 1; empty when it is not there.
  std::string_view field(std::size_t i) const { return i < fields_.size() ? fields_[i] : std::string_view(); }
  std::optional<double> number(std::size_t i) const { return number_in(field(i)); }

 private:
  std::vector<std::string_view> fields_;
};

/// What may be a sentence, from a dollar to the end of its line or the next one.
struct RawSentence {
  std::size_t at;            ///< of the dollar, in the text
  std::string_view body;     ///< between dollar and asterisk
  std::string_view address;  ///< at the front of the body
  std::string_view behind;   ///< all text from the end of the body on

  bool ends_its_line() const { return behind.starts_with('\r') || behind.starts_with('\n'); }
};

template <class Take>
void for_each_raw_sentence(std::string_view text, Take take) {
  for (std::size_t at = text.find('$'); at != std::string_view::npos; at = text.find('$', at + 1)) {
    const std::string_view rest = text.substr(at + 1);
    const std::size_t address = std::min(rest.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"), rest.size());
    // Other text has dollars, too.
    constexpr std::size_t kMinLength = 3, kMaxLength = 10;
    const bool is_sentence = address >= kMinLength && address <= kMaxLength && rest.substr(address).starts_with(',');
    if (!is_sentence) continue;
    const std::size_t end = std::min(rest.find_first_of("*$\r\n"), rest.size());
    take(RawSentence{at, rest.substr(0, end), rest.substr(0, address), rest.substr(end)});
  }
}

/// Whether it is one of those that are read.
bool is_known(std::string_view address) {
  constexpr std::string_view kRead = "GGA RMC GLL ZDA HDT HDM THS HDG DPT DBT MTW VBW";
  return address.size() == 5 && kRead.find(address.substr(2)) != std::string_view::npos;
}

/// The devices (first two letters) that send checksums. These are optional, but what lacks one of theirs is damaged.
std::set<std::string_view> talkers_with_checksums(std::string_view text) {
  std::set<std::string_view> talkers;
  for_each_raw_sentence(text, [&](const RawSentence& raw) {
    if (raw.behind.starts_with('*')) talkers.insert(raw.address.substr(0, 2));
  });
  return talkers;
}

/// Calls `take` for each sentence with a right checksum, or without one of a device that sends none, and its place in
/// the text. Others, and pieces, are damage.
/// @return how many there were
template <class Take>
std::size_t for_each_sentence(std::string_view text, std::vector<DamageKind>& damage, Take take) {
  const std::set<std::string_view> checked = talkers_with_checksums(text);
  std::size_t sentences = 0;
  for_each_raw_sentence(text, [&](const RawSentence& raw) {
    const bool has_sum = raw.behind.starts_with('*');
    const std::optional<unsigned> sum = has_sum ? hex_byte_in(raw.behind.substr(1, 2)) : std::nullopt;
    unsigned computed = 0;
    for (const char c : raw.body) computed ^= static_cast<unsigned char>(c);
    const bool needs_none =
        !has_sum && raw.ends_its_line() && is_known(raw.address) && !checked.contains(raw.address.substr(0, 2));
    if (!sum && !needs_none) {
      add_damage(damage, raw.behind.size() < 3 ? FrameFinder::kCutOff : "sentence without checksum", raw.at);
    } else if (sum && computed != *sum) {
      add_damage(damage, "wrong checksum", raw.at);
    } else {
      ++sentences;
      take(Sentence(raw.body), raw.at);
    }
  });
  return sentences;
}

/// Seconds since midnight of "hhmmss.s".
std::optional<double> time_of_day(std::string_view text) {
  if (text.size() < 6) return std::nullopt;
  const auto hours = count_in(text.substr(0, 2)), minutes = count_in(text.substr(2, 2));
  const auto seconds = number_in(text.substr(4));
  if (!hours || !minutes || !seconds || *hours > 23 || *minutes > 59 || !(*seconds >= 0.0 && *seconds < 61.0)) {
    return std::nullopt;
  }
  return static_cast<double>(*hours * 3600 + *minutes * 60) + *seconds;
}

/// Midnight of a date, since 1970.
std::optional<double> midnight(std::string_view day, std::string_view month, std::string_view year) {
  const auto d = count_in(day), m = count_in(month), y = count_in(year);
  if (!d || !m || !y || *d > 31 || *m > 12 || *y > 9999) return std::nullopt;
  // Two digits: computers and receivers whose clock was not set say 1970 or 1980.
  const auto full = static_cast<int>(*y) + (year.size() == 2 ? (*y < 70 ? 2000 : 1900) : 0);
  const std::chrono::year_month_day date(std::chrono::year(full), std::chrono::month(static_cast<unsigned>(*m)),
                                         std::chrono::day(static_cast<unsigned>(*d)));
  if (!date.ok()) return std::nullopt;
  return static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count()) * kDay_s;
}

/// When a sentence was true.
struct SentenceTime {
  std::optional<double> midnight_s, of_day_s;
  bool is_sure = true;  ///< false: the receiver has no fix, and its date may be one from the factory
};

SentenceTime time_in(const Sentence& sentence) {
  if (sentence.is("RMC")) {
    const std::string_view date = sentence.field(9);
    const bool has_date = date.size() == 6;
    return {has_date ? midnight(date.substr(0, 2), date.substr(2, 2), date.substr(4)) : std::nullopt,
            time_of_day(sentence.field(1)), sentence.field(2) == "A"};
  }
  if (sentence.is("ZDA")) {
    return {midnight(sentence.field(2), sentence.field(3), sentence.field(4)), time_of_day(sentence.field(1))};
  }
  if (sentence.is("GGA")) return {std::nullopt, time_of_day(sentence.field(1))};
  if (sentence.is("GLL")) return {std::nullopt, time_of_day(sentence.field(5))};
  return {};
}

/// The time of each sentence: its own, with the nearest day, or that of the last one that has one.
class Clock {
 public:
  explicit Clock(std::string_view text) {
    std::vector<DamageKind> ignored;
    std::optional<double> sure_s, unsure_s;
    for_each_sentence(text, ignored, [&](const Sentence& sentence, std::size_t) {
      const SentenceTime time = time_in(sentence);
      if (time.of_day_s && !time_s_) time_s_ = time.of_day_s;
      std::optional<double>& date_s = time.is_sure ? sure_s : unsure_s;
      if (time.of_day_s && time.midnight_s && !date_s) date_s = *time.midnight_s + *time.of_day_s;
    });
    has_sure_date_ = sure_s.has_value();
    const std::optional<double> date_s = sure_s ? sure_s : unsure_s;
    has_date_ = date_s.has_value();
    if (has_date_) time_s_ = on_day_near(*time_s_, *date_s);
  }

  bool has_date() const { return has_date_; }
  bool has_time() const { return time_s_.has_value(); }
  /// nullopt: no sentence of the log has a time.
  std::optional<double> time_of(const Sentence& sentence) {
    if (const SentenceTime time = time_in(sentence); time.of_day_s) {
      const bool has_date = time.midnight_s && (time.is_sure || !has_sure_date_);
      time_s_ = has_date ? *time.midnight_s + *time.of_day_s : on_day_near(*time.of_day_s, *time_s_);
    }
    return time_s_;
  }

 private:
  static double on_day_near(double of_day_s, double near_s) {
    return of_day_s + std::round((near_s - of_day_s) / kDay_s) * kDay_s;
  }

  std::optional<double> time_s_;
  bool has_date_ = false, has_sure_date_ = false;
};

/// Latitude and longitude of four fields: ddmm.mmm, N or S, dddmm.mmm, E or W. nullopt: there is none.
std::optional<Eigen::Vector2d> place_in(const Sentence& sentence, std::size_t first) {
  const auto angle = [&](std::size_t field, std::string_view positive, std::string_view negative,
                         double limit) -> std::optional<double> {
    const auto number = sentence.number(field);
    const std::string_view sense = sentence.field(field + 1);
    if (!number || (sense != positive && sense != negative)) return std::nullopt;
    const double angle_rad = angle_of_degrees_minutes(*number);
    if (std::fabs(angle_rad) > limit) return std::nullopt;
    return sense == positive ? angle_rad : -angle_rad;
  };
  const auto latitude = angle(first, "N", "S", std::numbers::pi / 2.0);
  const auto longitude = angle(first + 2, "E", "W", std::numbers::pi);
  if (!latitude || !longitude) return std::nullopt;
  return Eigen::Vector2d(*latitude, *longitude);
}

/// Whether an angle of degrees and minutes, if there is one, is within a limit.
bool is_possible_angle(std::optional<double> number, double limit_deg) {
  constexpr double kDegrees = 100.0, kMinutes = 60.0;
  if (!number) return true;
  const double size = std::fabs(*number);
  return std::fmod(size, kDegrees) < kMinutes && size <= limit_deg * kDegrees;
}

constexpr std::string_view kImpossibleValues = "impossible values",
                           kDecimalDegrees =
                               "latitude with less than three digits before the point: is it in decimal "
                               "degrees instead of ddmm.mmm?";

/// Whether degrees and minutes have too few digits for that.
bool is_in_decimal_degrees(std::string_view latitude) {
  constexpr std::size_t kMinDigits = 3;  // ddmm, without a leading zero
  const std::size_t sign = latitude.starts_with('-') || latitude.starts_with('+') ? 1 : 0;
  const std::size_t digits = std::min(latitude.find('.'), latitude.size()) - sign;
  return number_in(latitude).value_or(0.0) != 0.0 && digits < kMinDigits;
}

/// What is wrong with a place of four fields; empty: nothing.
std::string_view fault_of_place(const Sentence& sentence, std::size_t first) {
  constexpr double kPole_deg = 90.0, kHalfTurn_deg = 180.0;
  const std::optional<double> latitude = sentence.number(first), longitude = sentence.number(first + 2);
  if (is_in_decimal_degrees(sentence.field(first))) return kDecimalDegrees;
  if (!is_possible_angle(latitude, kPole_deg) || !is_possible_angle(longitude, kHalfTurn_deg)) return kImpossibleValues;
  // Both a sign and a letter.
  const bool is_twice_south = latitude.value_or(0.0) < 0.0 && sentence.field(first + 1) == "S";
  const bool is_twice_west = longitude.value_or(0.0) < 0.0 && sentence.field(first + 3) == "W";
  return is_twice_south || is_twice_west ? kImpossibleValues : std::string_view();
}

/// What is wrong with the place or direction of a sentence; empty: nothing.
std::string_view fault_of(const Sentence& sentence) {
  constexpr double kTurn_deg = 360.0;
  if (sentence.is("GGA")) return fault_of_place(sentence, 2);
  if (sentence.is("RMC")) return fault_of_place(sentence, 3);
  if (sentence.is("GLL")) return fault_of_place(sentence, 1);
  const bool is_heading = sentence.is("HDT") || sentence.is("HDM") || sentence.is("THS") || sentence.is("HDG");
  const bool is_possible = !is_heading || std::fabs(sentence.number(1).value_or(0.0)) <= kTurn_deg;
  return is_possible ? std::string_view() : kImpossibleValues;
}

class NmeaNav {
 public:
  void add(const Sentence& sentence, double time_s) {
    name_ = sentence.address();
    time_s_ = time_s;
    if (sentence.is("GGA")) {
      add_fix(sentence, 2, sentence.number(6).value_or(0.0) > 0.0, sentence.number(9).value_or(0.0));
    }
    if (sentence.is("RMC")) add_fix(sentence, 3, sentence.field(2) == "A", 0.0);
    if (sentence.is("GLL")) add_fix(sentence, 1, sentence.field(6) != "V", 0.0);
    if (sentence.is("HDT") || sentence.is("HDM")) add_heading(sentence.number(1), true);
    if (sentence.is("THS")) add_heading(sentence.number(1), sentence.field(2) != "V");
    if (sentence.is("HDG")) add_compass(sentence);
    if (sentence.is("DPT")) add_range(sentence.number(1));
    if (sentence.is("MTW") && sentence.number(1)) put(NavQuantity::kTemperature, {*sentence.number(1), 0.0, 0.0}, true);
    if (sentence.is("DBT")) add_range(sentence.number(3));
    if (sentence.is("VBW")) add_velocity(sentence);
  }

  std::vector<NavSource> take() { return sources_.take(); }

 private:
  void add_fix(const Sentence& sentence, std::size_t first, bool valid, double altitude_m) {
    if (const auto place = place_in(sentence, first)) {
      put(NavQuantity::kFix, {place->x(), place->y(), altitude_m}, valid);
    }
  }

  void add_heading(std::optional<double> heading_deg, bool valid) {
    if (heading_deg) put(NavQuantity::kHeading, {from_ned::yaw(*heading_deg * kDegree_rad), 0.0, 0.0}, valid);
  }

  /// Magnetic, with the compass's own deviation and the variation where the sentence has them.
  void add_compass(const Sentence& sentence) {
    auto heading_deg = sentence.number(1);
    if (!heading_deg) return;
    for (const std::size_t field : {2U, 4U}) {
      const double sense = sentence.field(field + 1) == "W" ? -1.0 : 1.0;
      *heading_deg += sense * sentence.number(field).value_or(0.0);
    }
    add_heading(heading_deg, true);
  }

  void add_range(std::optional<double> range_m) {
    if (range_m) put(NavQuantity::kRange, {*range_m, 0.0, 0.0}, *range_m > 0.0);
  }

  /// Over ground: ahead, and to starboard.
  void add_velocity(const Sentence& sentence) {
    const auto ahead = sentence.number(4), right = sentence.number(5);
    if (!ahead || !right) return;
    put(NavQuantity::kVelocity, Eigen::Vector3d(*ahead, -*right, 0.0) * kMetresPerSecondOfKnot,
        sentence.field(6) == "A");
  }

  void put(NavQuantity quantity, const Eigen::Vector3d& value, bool valid) {
    NavSample sample;
    sample.time_s = time_s_;
    sample.value = value;
    sample.valid = valid;
    sources_.add(name_, quantity, sample);
  }

  NavSources sources_;
  std::string name_;
  double time_s_ = 0.0;
};

}  // namespace

bool looks_like_nmea(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kLookedAt = 4096;
  const std::string_view beginning = text_of(bytes.first(std::min(bytes.size(), kLookedAt)));
  const bool is_text =
      std::ranges::all_of(beginning, [](char c) { return (c >= ' ' && c <= '~') || (c >= '\t' && c <= '\r'); });
  std::vector<DamageKind> ignored;
  return is_text && for_each_sentence(beginning, ignored, [](const Sentence&, std::size_t) {}) > 0;
}

NavReading read_nmea(std::span<const std::uint8_t> bytes) {
  NavReading reading;
  const std::string_view text = text_of(bytes);
  Clock clock(text);
  if (clock.has_date()) reading.clock = NavClock::kUnix;
  NmeaNav nav, decimal;
  reading.records = for_each_sentence(text, reading.damage, [&](const Sentence& sentence, std::size_t at) {
    const double time_s = clock.time_of(sentence).value_or(0.0);
    if (const std::string_view fault = fault_of(sentence); fault.empty()) {
      nav.add(sentence, time_s);
    } else {
      if (fault == kDecimalDegrees) decimal.add(sentence, time_s);
      add_damage(reading.damage, fault, at);
    }
  });
  reading.sources = nav.take();
  for (NavSource& source : decimal.take()) {
    const bool has_others = std::ranges::any_of(reading.sources, [&](const NavSource& other) {
      return other.quantity == source.quantity && other.name == source.name;
    });
    if (has_others) continue;
    source.fault = kDecimalDegrees;
    reading.sources.push_back(std::move(source));
  }
  if (clock.has_time()) return reading;
  std::size_t samples = 0;
  for (const NavSource& source : reading.sources) samples += source.samples.size();
  if (samples > 0) reading.damage.push_back({"sample of a log without any time", samples, std::nullopt});
  reading.sources.clear();
  return reading;
}

}  // namespace pingvox
