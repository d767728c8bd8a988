#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "pingvox/io/beam_topic.hpp"
#include "pingvox/io/bytes.hpp"
#include "pingvox/io/nav_fields.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Which messages of ROS bags are beams and navigation, where their types do not determine it.
struct BagFields {
  std::optional<BeamTopic> beams = std::nullopt;
  std::vector<NavFields> nav = {};
};

/// Reads a TOML file of [[beams]] and [[nav]] (docs/formats.md).
/// @return kCorrupt naming the line of an unknown, missing or repeated field
Result<BagFields> read_bag_fields(const FileBytes& file);

/// The fields that make a message a beam, as in "angle=heading,unit=deg,turn=cw,range=max_range,intensities=data".
/// @return kBadOption naming what is unknown or missing
Result<BeamFields> beam_fields_from(std::string_view text);

}  // namespace pingvox
