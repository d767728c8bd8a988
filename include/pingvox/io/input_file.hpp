#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <variant>

#include "pingvox/io/byte_stream.hpp"
#include "pingvox/io/bytes.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// A file to read: by its path, or its bytes in memory. It can be opened again and again, but for standard input and
/// pipes.
class InputFile {
 public:
  // NOLINTBEGIN(google-explicit-constructor): functions of files accept paths and bytes
  /// @param path  "-" is standard input
  InputFile(std::string path) : from_(std::move(path)) {}
  InputFile(const char* path) : from_(std::string(path)) {}
  InputFile(const std::filesystem::path& path) : from_(path.string()) {}
  InputFile(FileBytes file) : from_(std::make_shared<const FileBytes>(std::move(file))) {}
  // NOLINTEND(google-explicit-constructor)

  /// For messages and reports: the path, or the name of the bytes.
  const std::string& name() const;
  bool is_standard_input() const;
  /// Standard input, or what is no file of bytes, such as a pipe.
  bool is_read_once() const;
  /// @return kIo naming it when it cannot be opened
  Result<ByteStream> open() const;

 private:
  std::variant<std::string, std::shared_ptr<const FileBytes>> from_;
};

}  // namespace pingvox
