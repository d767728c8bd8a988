#pragma once

#include <string>
#include <vector>

#include "pingvox/result.hpp"

namespace pingvox::app {

/// The files that a command reads and writes, each with the option that names it.
class CommandFiles {
 public:
  using Paths = std::vector<std::string>;

  /// An empty path is none.
  void read(const std::string& option, const std::string& path);
  void read(const std::string& option, const Paths& paths);
  void write(const std::string& option, const std::string& path);

  /// Checks that standard input and output are used once, and that no output is an input, a file of a bag in a folder
  /// or another output, also by another name. Devices and pipes may be used several times. kBadOption names both
  /// options and the files.
  Result<void> check() const;

 private:
  struct NamedFile {
    std::string option, path;
  };

  std::vector<NamedFile> inputs_, outputs_;
};

/// The two files of a grid for map_server, whichever of them is named as the output.
struct GridFiles {
  std::string picture, about;
};
GridFiles grid_files(const std::string& output);

/// Checks before the work that a file can be created here.
Result<void> check_folder_of(const std::string& path);

}  // namespace pingvox::app
