#include "io/internal/unknown_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

#include "io/internal/mavlink.hpp"

namespace pingvox {
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
    Signature{"II*\0"sv, "is a TIFF", kWrittenOnly},
    Signature{"LASF"sv, "is a cloud of points in LAS", kWrittenOnly},
    Signature{"glTF"sv, "is a mesh in glTF", kWrittenOnly},
    Signature{R"({"type":"FeatureCollection")"sv, "is a path as GeoJSON", kWrittenOnly},
    Signature{kTrueRangesHeader, "has the true ranges of a simulated world", kWrittenOnly},
    Signature{"#ROSBAG "sv, "is a ROS bag of a version before 2.0", "convert it with 'rosbag fix'"},
    Signature{"%time,"sv, "is CSV of 'rostopic echo -p'", "give the bag, which pingvox reads itself"},
    Signature{"\x89HDF"sv, "is an HDF5 file", kAsCsv},
    Signature{"\x7f\x7f"sv, "is a DVL log in PD0, which pingvox does not read", kAsNavCsv},
    Signature{":SA,"sv, "is a DVL log in PD6, which pingvox does not read", kAsNavCsv},
    Signature{"\xa3\x95"sv, "is a DataFlash log without the definitions of its records (FMT) at its beginning",
              "its records cannot be decoded without them; a telemetry log (.tlog) of the same dive can be read"},
};

/// Whether it begins with MAVLink as it is sent.
bool is_raw_mavlink(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kSearched = 600;  // two frames: the first one may be cut
  for (std::size_t at = 0; at < std::min(bytes.size(), kSearched); ++at) {
    const MavlinkRead read = read_mavlink(bytes.subspan(at));
    if (read.frame && read.frame->check == MavlinkFrame::Check::kRight) return true;
  }
  return false;
}

/// Whether the first line that is no comment is one of a log of CARMEN.
bool is_carmen(std::string_view text) {
  constexpr std::array kMessages = {"PARAM "sv,       "SYNC "sv,        "ODOM "sv,      "FLASER "sv, "RLASER "sv,
                                    "ROBOTLASER1 "sv, "ROBOTLASER2 "sv, "RAWLASER1 "sv, "TRUEPOS "sv};
  while (text.starts_with('#') || text.starts_with('\n') || text.starts_with('\r')) {
    text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  }
  return std::ranges::any_of(kMessages, [&](std::string_view message) { return text.starts_with(message); });
}

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
  if (known != kSignatures.end()) return fmt::format("{}: {}", known->what, known->advice);
  if (is_raw_mavlink(bytes)) {
    return "is MAVLink without the time of each message: the telemetry log of a ground station (.tlog) has these times";
  }
  if (is_carmen(text)) {
    return "is a log of a laser scanner by CARMEN, which pingvox does not read: scans can be given as a log of OctoMap "
           "(NODE x y z roll pitch yaw, then a point in each line) or as clouds (.xyz)";
  }
  return std::nullopt;
}

std::string describe_unknown_file(std::span<const std::uint8_t> bytes) {
  if (auto known = describe_unread_file(bytes)) return *std::move(known);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (is_text(text)) {
    return "is text of no known format: beams as CSV begin with the line "
           "'time_s,bearing_cw_deg,bin_length_m,intensities', and points have a line 'x y z' each "
           "(docs/formats.md)";
  }
  return fmt::format("is not a log, cloud, map, mesh or trajectory that pingvox reads: {}", kAsCsv);
}

bool is_true_ranges(std::span<const std::uint8_t> bytes) {
  return std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()).starts_with(kTrueRangesHeader);
}

}  // namespace pingvox
