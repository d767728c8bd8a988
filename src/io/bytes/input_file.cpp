#include "pingvox/io/input_file.hpp"

#include <system_error>

namespace pingvox {

const std::string& InputFile::name() const {
  const auto* const path = std::get_if<std::string>(&from_);
  return path != nullptr ? *path : std::get<std::shared_ptr<const FileBytes>>(from_)->name;
}

bool InputFile::is_standard_input() const {
  const auto* const path = std::get_if<std::string>(&from_);
  return path != nullptr && *path == "-";
}

bool InputFile::is_read_once() const {
  const auto* const path = std::get_if<std::string>(&from_);
  std::error_code error;
  return path != nullptr && (*path == "-" || std::filesystem::is_other(std::filesystem::status(*path, error)));
}

Result<ByteStream> InputFile::open() const {
  if (const auto* const path = std::get_if<std::string>(&from_)) return ByteStream::open(*path);
  return ByteStream(*std::get<std::shared_ptr<const FileBytes>>(from_));
}

}  // namespace pingvox
