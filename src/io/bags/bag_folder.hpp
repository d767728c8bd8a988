#pragma once

#include <string>
#include <vector>

#include "pingvox/result.hpp"

namespace pingvox {

/// The files of the ROS 2 bag in a folder, in their order: those that metadata.yaml lists, else the only one there, or
/// all of one series (dive_0.db3, dive_1.db3). Without metadata.yaml there must be no other files: a folder of logs is
/// no bag.
/// @return kIo naming what is missing, or what to name instead
Result<std::vector<std::string>> bag_files_in(const std::string& folder);

}  // namespace pingvox
