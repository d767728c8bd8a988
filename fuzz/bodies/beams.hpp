#pragma once

#include <cstdint>
#include <span>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "fuzz/bodies/require.hpp"
#include "pingvox/io/beams.hpp"

namespace pingvox::fuzz {

struct BeamsRead {
  std::vector<Beam> beams;
  bool failed = false;
};

inline BeamsRead beams_in(std::span<const std::uint8_t> bytes, Damage damage) {
  BeamsRead read;
  const auto fails = [&read](const Error& error) {
    require(!error.message.empty() && error.message.find('\n') == std::string::npos, "an error is one line");
    read.failed = true;
  };
  const auto source = open_beams({"fuzzed", {bytes.begin(), bytes.end()}}, damage);
  if (!source) {
    fails(source.error());
    return read;
  }
  for (;;) {
    auto beam = (*source)->next();
    if (!beam && beam.error().code == Error::Code::kBadOption) break;  // a choice is needed: a topic
    if (!beam) fails(beam.error());
    if (!beam || !*beam) break;
    require(validate(**beam).has_value(), "each beam that is read is valid");
    read.beams.push_back(std::move(**beam));
  }
  require(damage == Damage::kFail || !read.failed, "damage that is not fatal at the start is stepped over");
  require(damage == Damage::kSkip || ((*source)->skipped() > 0) == read.failed, "the first damage ends a strict read");
  return read;
}

inline bool is_same(const Beam& a, const Beam& b) {
  return a.time_s == b.time_s && a.bearing_rad == b.bearing_rad && a.bin_length_m == b.bin_length_m &&
         a.intensities == b.intensities;
}

/// Any bytes as a log of beams: what is read is valid, a strict read is the start of a lenient one, and CSV gives all
/// of it back.
inline std::size_t beams(std::span<const std::uint8_t> bytes) {
  const BeamsRead lenient = beams_in(bytes, Damage::kSkip);
  const BeamsRead strict = beams_in(bytes, Damage::kFail);
  require(strict.beams.size() <= lenient.beams.size(), "a strict read gives no more");
  for (std::size_t i = 0; i < strict.beams.size(); ++i) {
    require(is_same(strict.beams[i], lenient.beams[i]), "a strict read gives the same");
  }
  if (lenient.beams.empty()) return 0;

  BeamsInMemory source(lenient.beams);
  std::stringstream text;
  require(write_csv(source, text) == lenient.beams.size(), "all beams are written");
  const std::string csv = text.str();
  const BeamsRead back = beams_in({reinterpret_cast<const std::uint8_t*>(csv.data()), csv.size()}, Damage::kFail);
  require(!back.failed && back.beams.size() == lenient.beams.size(), "what is written is read");
  for (std::size_t i = 0; i < back.beams.size(); ++i) {
    require(is_same(back.beams[i], lenient.beams[i]), "what is read is what was written");
  }
  return lenient.beams.size();
}

}  // namespace pingvox::fuzz
