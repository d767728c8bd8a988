#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pingvox/io/beams.hpp"
#include "pingvox/io/byte_stream.hpp"
#include "pingvox/io/nav.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// A topic of a ROS bag. Publishers of one topic are counted as one.
struct BagTopicSummary {
  enum class Use { kBeams, kNavigation, kNone };

  std::string name, type;
  std::size_t messages = 0;
  Use use = Use::kNone;
};

/// What a ROS bag holds: its topics in the order in which they were met, and its navigation.
struct BagContents {
  std::vector<BagTopicSummary> topics;
  NavFile nav;
};

/// Reads a bag of ROS 1 or ROS 2 once, one chunk in memory at a time.
/// @return kUnsupported when it is none; with Damage::kFail, kCorrupt naming the first damage
Result<BagContents> read_bag(ByteStream stream, Damage damage = Damage::kSkip);

}  // namespace pingvox
