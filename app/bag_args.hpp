#pragma once

#include <string>
#include <vector>

#include "pingvox/io/beam_topic.hpp"
#include "pingvox/io/nav_fields.hpp"
#include "pingvox/result.hpp"

namespace pingvox::app {

/// How ROS bags are read, where the types of their messages do not tell: --topic and --fields.
struct BagArgs {
  BeamTopic beams;
  std::vector<NavFields> nav;
  std::string file = {};  ///< that --fields names; empty: none
};

/// Takes the value of --fields: the fields of beams as "angle=heading,range=...", or the name of a TOML file with those
/// of beams and navigation (docs/formats.md).
/// @return kBadOption or, of a file, kIo and kCorrupt naming the line
Result<void> take_fields(const std::string& text, BagArgs& bag);

}  // namespace pingvox::app
