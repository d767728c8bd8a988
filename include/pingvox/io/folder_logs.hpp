#pragma once

#include <string>
#include <vector>

#include "pingvox/result.hpp"

namespace pingvox {

/// The files of a folder that a recording may be made of, by their content and in the order of their names.
struct FolderLogs {
  std::vector<std::string> logs;     ///< of beams; without any, of scans
  std::vector<std::string> nav;      ///< navigation logs
  std::vector<std::string> others;   ///< names of what is left out
  std::vector<std::string> folders;  ///< names of the folders in it
};

/// Looks at the files of a folder, but not into folders in it, nor at hidden files.
/// @return kIo when the folder cannot be read
Result<FolderLogs> logs_in_folder(const std::string& folder);

/// Files that are read with a log: those of times of Format::kBeamHits.
std::vector<std::string> files_beside_log(const std::string& log);

/// The files in a folder and all folders in it, by their content and in the order of their paths.
struct FolderTree {
  std::vector<std::string> logs;     ///< of beams or scans
  std::vector<std::string> nav;      ///< navigation logs
  std::vector<std::string> bags;     ///< of ROS, which may hold either or both; folders that are one bag are among them
  std::vector<std::string> unknown;  ///< what is of no known format
  /// A file or folder that cannot be read, and why.
  struct Unreadable {
    std::string path, reason;
  };
  std::vector<Unreadable> unreadable;
};

/// Looks at the files of a folder and of the folders in it; hidden ones are left out, and links to folders are not
/// followed. Maps, trajectories, clouds and the like are left out.
/// @return kIo when the folder itself cannot be read
Result<FolderTree> logs_below_folder(const std::string& folder);

}  // namespace pingvox
