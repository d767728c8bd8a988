#include "unknown_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

namespace pingvox::app {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view kCompressed = "is compressed", kUnpack = "unpack it first";
constexpr std::string_view kUtf16 = "is text in UTF-16", kSaveAgain = "save it as UTF-8";
constexpr std::string_view kAsCsv =
    "write its beams as CSV, with 'time_s,bearing_cw_deg,bin_length_m,intensities' as the first line "
    "(bearings clockwise from ahead, as most sonars count them; bearing_deg is counter-clockwise; docs/formats.md)";
constexpr std::string_view kAsNavCsv =
    "write its velocities as CSV, with 'time_s,source,quantity,x,y,z' as the first line (docs/formats.md)";
constexpr std::string_view kWrittenOnly = "pingvox writes this format, but does not read it";

/// Common files of other kinds, by their first bytes.
struct Signature {
  std::string_view begin, what, advice;
};
constexpr std::array kSignatures = {
    Signature{"\x1f\x8b"sv, kCompressed, kUnpack},
    Signature{"BZh"sv, kCompressed, kUnpack},
    Signature{"\xfd\x37zXZ"sv, kCompressed, kUnpack},
    Signature{"\x28\xb5\x2f\xfd"sv, kCompressed, kUnpack},
    Signature{"PK\x03\x04"sv, kCompressed, kUnpack},
    Signature{"version https://git-lfs"sv, "is a pointer of Git LFS", "'git lfs pull' fetches the file itself"},
    Signature{"\xff\xfe"sv, kUtf16, kSaveAgain},
    Signature{"\xfe\xff"sv, kUtf16, kSaveAgain},
    Signature{"\x89PNG"sv, "is a picture", "pingvox writes pictures, but does not read them"},
    Signature{"P5\n# pingvox"sv, "is a grid for map_server", kWrittenOnly},
    Signature{"image: "sv, "describes a grid for map_server", kWrittenOnly},
    Signature{"ncols "sv, "is a grid of heights", kWrittenOnly},
    Signature{kTrueRangesHeader, "has the true ranges of 'pingvox simulate --truth'", kWrittenOnly},
    Signature{"#ROSBAG "sv, "is a ROS bag of a version before 2.0", "convert it with 'rosbag fix'"},
    Signature{"%time,"sv, "is CSV of 'rostopic echo -p'", "give the bag, which pingvox reads itself"},
    Signature{"\x89HDF"sv, "is an HDF5 file", kAsCsv},
    Signature{"\x7f\x7f"sv, "is a DVL log in PD0, which pingvox does not read", kAsNavCsv},
    Signature{":SA,"sv, "is a DVL log in PD6, which pingvox does not read", kAsNavCsv},
};

/// Whether the bytes are text.
bool is_text(std::string_view bytes) {
  constexpr std::size_t kLookedAt = 4096;
  return std::ranges::all_of(bytes.substr(0, kLookedAt), [](char byte) {
    const auto code = static_cast<unsigned char>(byte);
    return code >= ' ' || (code >= '\t' && code <= '\r');
  });
}

}  // namespace

std::optional<std::string> describe_unread_file(std::span<const std::uint8_t> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto known =
      std::ranges::find_if(kSignatures, [&](const Signature& signature) { return text.starts_with(signature.begin); });
  if (known == kSignatures.end()) return std::nullopt;
  return fmt::format("{}: {}", known->what, known->advice);
}

std::string describe_unknown_file(std::span<const std::uint8_t> bytes) {
  if (auto known = describe_unread_file(bytes)) return *std::move(known);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (is_text(text)) {
    return "is text of no known format: beams as CSV begin with the line "
           "'time_s,bearing_cw_deg,bin_length_m,intensities' "
           "(docs/formats.md)";
  }
  return fmt::format("is none of the logs, clouds, maps, meshes and trajectories that pingvox reads: {}", kAsCsv);
}

bool is_true_ranges(std::span<const std::uint8_t> bytes) {
  return std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()).starts_with(kTrueRangesHeader);
}

}  // namespace pingvox::app
