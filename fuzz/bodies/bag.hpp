#pragma once

#include <cstdint>
#include <span>

#include "fuzz/bodies/beams.hpp"
#include "fuzz/bodies/nav.hpp"

namespace pingvox::fuzz {

/// Any bytes as a ROS bag: its beams and its navigation.
/// @return beams and samples
inline std::size_t bag(std::span<const std::uint8_t> bytes) {
  return beams(bytes) + nav(bytes);
}

}  // namespace pingvox::fuzz
