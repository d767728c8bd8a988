#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/bytes/scalar.hpp"
#include "pingvox/result.hpp"

// The header of a PLY file.
namespace pingvox {

struct PlyProperty {
  std::string name;
  Scalar type = Scalar::kFloat;
  std::optional<Scalar> list_count;  ///< type of the length of a list; nullopt: not a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

enum class PlyFormat { kText, kLittle, kBig };

struct PlyHeader {
  std::optional<PlyFormat> format;  ///< set by read_ply_header
  std::vector<PlyElement> elements;
  std::size_t size = 0;   ///< bytes
  std::size_t lines = 0;  ///< of text
};

bool looks_like_ply(std::span<const std::uint8_t> bytes);

/// @param file  its name, for messages
/// @return kCorrupt naming the line
Result<PlyHeader> read_ply_header(std::string_view file, std::span<const std::uint8_t> bytes);

/// Whether a PLY file has faces; else it is a cloud. false for a damaged header.
bool is_ply_with_faces(std::span<const std::uint8_t> bytes);

}  // namespace pingvox
