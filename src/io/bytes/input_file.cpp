#include "pingvox/io/input_file.hpp"

namespace pingvox {

const std::string& InputFile::name() const {
  const auto* const path = std::get_if<std::string>(&from_);
  return path != nullptr ? *path : std::get<std::shared_ptr<const FileBytes>>(from_)->name;
}

bool InputFile::is_standard_input() const {
  const auto* const path = std::get_if<std::string>(&from_);
  return path != nullptr && *path == "-";
}

Result<ByteStream> InputFile::open() const {
  if (const auto* const path = std::get_if<std::string>(&from_)) return ByteStream::open(*path);
  return ByteStream(*std::get<std::shared_ptr<const FileBytes>>(from_));
}

}  // namespace pingvox
