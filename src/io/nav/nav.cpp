#include "pingvox/io/nav.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/without_exceptions.hpp"
#include "io/nav/nav_readers.hpp"
#include "io/nav/nav_sources.hpp"
#include "pingvox/geometry/degree.hpp"
#include "pingvox/io/bag.hpp"
#include "pingvox/io/format.hpp"

namespace pingvox {

namespace {

/// A source without samples yet.
NavSource new_source(const std::string& name, NavQuantity quantity, const NavOrigin& origin) {
  NavSource source{name, quantity, {}};
  source.subject = origin.subject;
  switch (quantity) {
    case NavQuantity::kPosition:
    case NavQuantity::kAttitude:
    case NavQuantity::kHeading:
      source.frame = origin.frame;
      source.child = origin.child;
      break;
    case NavQuantity::kVelocity:
    case NavQuantity::kTurnRate:
      source.frame = origin.child;
      break;
    default:
      break;
  }
  return source;
}

}  // namespace

NavSample* NavSources::add(const std::string& name, NavQuantity quantity, const NavSample& sample,
                           const NavOrigin& origin) {
  if (!std::isfinite(sample.time_s) || !sample.value.allFinite()) return nullptr;
  const auto [place, is_new] = places_.try_emplace({name, quantity}, sources_.size());
  if (is_new) sources_.push_back(new_source(name, quantity, origin));
  std::vector<NavSample>& samples = sources_[place->second].samples;
  samples.push_back(sample);
  return &samples.back();
}

double angle_of_degrees_minutes(double number) {
  const double degrees = std::trunc(number / 100.0);
  return (degrees + (number - 100.0 * degrees) / 60.0) * kDegree_rad;
}

Result<NavFile> read_nav(const FileBytes& file, Damage damage) {
  return detail::without_exceptions(file.name, [&]() -> Result<NavFile> {
    const std::optional<Format> format = format_of(file.view());
    if (format && is_bag(*format)) return read_nav(ByteStream(file), damage);
    NavReading reading;
    if (format == Format::kTlog) {
      reading = read_tlog(file.view());
    } else if (format == Format::kDataflash) {
      reading = read_dataflash(file.view());
    } else if (format == Format::kIctineu) {
      reading = read_ictineu(file.view());
    } else if (format == Format::kDvlA50) {
      reading = read_a50(file.view());
    } else if (format == Format::kNmea) {
      reading = read_nmea(file.view());
    } else if (format == Format::kNavCsv) {
      reading = read_nav_csv(file.view());
    } else {
      const std::string what = format ? fmt::format("is {}, not a navigation log", description_of(*format))
                               : file.bytes.empty() ? "is empty"
                                                    : "is not a navigation log";
      return fail(Error::Code::kUnsupported, fmt::format("{}: {}", file.name, what));
    }
    if (damage == Damage::kFail && !reading.damage.empty()) {
      return fail(Error::Code::kCorrupt, fmt::format("{}: {}", file.name, first_damage_text(reading.damage.front())));
    }
    Result<NavLog> log = NavLog::make(std::move(reading.sources), reading.clock);
    if (!log) return fail(log.error().code, fmt::format("{}: {}", file.name, log.error().message));
    return NavFile{*std::move(log),
                   reading.records,
                   std::move(reading.damage),
                   std::move(reading.notes),
                   std::move(reading.settings),
                   std::move(reading.runs)};
  });
}

Result<NavFile> read_nav(ByteStream stream, Damage damage) {
  const std::string name = stream.name();
  return detail::without_exceptions(name, [&]() -> Result<NavFile> {
    if (const auto streamed = streamed_format_of(stream.beginning()); streamed && is_bag(*streamed)) {
      return read_bag(std::move(stream), damage).map([](BagContents bag) { return std::move(bag.nav); });
    }
    const Result<FileBytes> file = ByteStream::whole(std::move(stream));
    if (!file) return tl::unexpected(file.error());
    return read_nav(*file, damage);
  });
}

}  // namespace pingvox
