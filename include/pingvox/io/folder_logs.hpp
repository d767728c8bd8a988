#pragma once

#include <string>
#include <vector>

#include "pingvox/result.hpp"

namespace pingvox {

/// The files of a folder that a recording may be made of, by their content and in the order of their names.
struct FolderLogs {
  std::vector<std::string> logs;    ///< of beams; without any, of scans
  std::vector<std::string> nav;     ///< navigation logs
  std::vector<std::string> others;  ///< names of what is left out
};

/// Looks at the files of a folder, but not into folders in it, nor at hidden files.
/// @return kIo when the folder cannot be read
Result<FolderLogs> logs_in_folder(const std::string& folder);

}  // namespace pingvox
