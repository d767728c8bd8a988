#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): mkdtemp

#include <filesystem>
#include <string>
#include <system_error>

namespace pingvox::test {

/// A folder of its own, gone with the test: tests run at the same time, and so may whole runs of them.
class Folder {
 public:
  Folder() {
    std::string path = (std::filesystem::temp_directory_path() / "pingvox-test-XXXXXX").string();
    if (!::mkdtemp(path.data())) ADD_FAILURE() << "no folder for the test: " << path;
    path_ = path;
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  const std::filesystem::path& path() const { return path_; }
  std::string path(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

}  // namespace pingvox::test
