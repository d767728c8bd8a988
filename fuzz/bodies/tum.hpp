#pragma once

#include <cstdint>
#include <span>
#include <sstream>
#include <string>

#include "fuzz/bodies/require.hpp"
#include "pingvox/io/tum.hpp"

namespace pingvox::fuzz {

/// Any bytes as a trajectory: what is read holds rigid poses, and is written and read back.
/// @return poses read
inline std::size_t tum(std::span<const std::uint8_t> bytes) {
  const auto read = read_tum({"fuzzed", {bytes.begin(), bytes.end()}});
  if (!read) {
    require(read.error().message.starts_with("fuzzed"), "an error names the file");
    return 0;
  }
  for (const StampedPose& pose : read->poses()) {
    const Eigen::Matrix3d rotation = pose.map_from_body.linear();
    require((rotation * rotation.transpose()).isIdentity(1e-9) && rotation.determinant() > 0.0, "rotations are such");
  }
  std::stringstream text;
  require(write_tum(*read, text).has_value(), "what is read is written");
  const std::string written = text.str();
  const auto back = read_tum({"written", {written.begin(), written.end()}});
  require(back && back->poses().size() == read->poses().size(), "what is written is read");
  for (std::size_t i = 0; i < back->poses().size(); ++i) {
    const StampedPose &a = read->poses()[i], &b = back->poses()[i];
    require(a.time_s == b.time_s && a.map_from_body.translation() == b.map_from_body.translation(),
            "what is read is what was written");
    require(a.map_from_body.linear().isApprox(b.map_from_body.linear(), 1e-12), "rotations come back");
  }
  return back->poses().size();
}

}  // namespace pingvox::fuzz
