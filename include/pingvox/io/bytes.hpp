#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace pingvox {

/// A file's contents and the name to use for it in messages. Readers never open anything themselves.
struct FileBytes {
  std::string name;
  std::vector<std::uint8_t> bytes;

  std::span<const std::uint8_t> view() const { return bytes; }
};

}  // namespace pingvox
