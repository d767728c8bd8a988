#pragma once

#include <string>
#include <vector>

#include "io/internal/json.hpp"
#include "map_report.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/io/nav.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/beam.hpp"

/// The report of 'info' on a file.
namespace pingvox::app {

/// A report as text and JSON.
struct Summary {
  JsonObject json;
  std::string text;
};

/// "dive.csv: a log of beams": the first line.
std::string headline(const std::string& name, Format format);
/// Kinds of damage, each with its place.
void add_damage(Summary& summary, const std::vector<DamageKind>& kinds);

template <typename Source>
std::string skipped_line(const Source& source) {
  return report_line("skipped", damage_text(source.skipped(), source.first_damage()));
}

/// Of a log of beams, read to its end.
Result<Summary> summarize_beams(BeamSource& source, const std::string& name, Format format);

}  // namespace pingvox::app
