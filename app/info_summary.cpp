#include "info_summary.hpp"

#include <fmt/core.h>

#include <span>

#include "console.hpp"

namespace pingvox::app {

std::string headline(const std::string& name, Format format) {
  return fmt::format("{}: {}\n", on_one_line(name), description_of(format));
}

void add_damage(Summary& summary, const std::vector<DamageKind>& kinds) {
  if (kinds.empty()) return;
  std::vector<JsonObject> list;
  for (const DamageKind& kind : kinds) {
    JsonObject& json = list.emplace_back();
    json.add("what", kind.what).add("count", kind.count);
    if (kind.first_byte) json.add("first_byte", *kind.first_byte);
    summary.text +=
        report_line("", fmt::format("{} x {}", kind.count, kind.what) +
                            (kind.first_byte ? fmt::format(", first at byte {}", *kind.first_byte) : std::string()));
  }
  summary.json.add("damage", std::span<const JsonObject>(list));
}

}  // namespace pingvox::app
