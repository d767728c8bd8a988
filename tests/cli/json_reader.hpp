#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace pingvox::test {

/// A JSON object, flat: "map.bounds.min" -> "[-1, 0, 2]". Strings keep their quotes, arrays and numbers their spelling.
using FlatJson = std::map<std::string, std::string>;

/// Reads exactly one JSON object (RFC 8259) with one line break behind it. nullopt: anything else, a key that comes
/// twice included.
std::optional<FlatJson> flat_json(std::string_view text);

}  // namespace pingvox::test
