#include "pingvox/io/format.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "io/bags/bag.hpp"
#include "io/bytes/byte_reader.hpp"
#include "io/bytes/text.hpp"
#include "io/clouds/ply_header.hpp"
#include "io/nav/nav_readers.hpp"
#include "io/readers.hpp"
#include "pingvox/io/byte_stream.hpp"

namespace pingvox {
namespace {

/// The binary tree of OctoMap's first days: i32 3, f64 resolution, u32 nodes, and two bytes for each inner node.
bool looks_like_oldest_bt(std::span<const std::uint8_t> bytes) {
  ByteReader reader(bytes);
  const auto version = reader.read<std::int32_t>();
  const auto resolution_m = reader.read<double>();
  const auto nodes = reader.read<std::uint32_t>();
  if (!version || !resolution_m || !nodes || *version != 3) return false;
  // Other files that begin with a 3 by chance do not have this number here.
  return std::isfinite(*resolution_m) && *resolution_m >= 1e-6 && *resolution_m <= 1e6 &&
         reader.left() / 2 <= std::uint64_t{*nodes};
}

struct FormatFacts {
  Format format;
  std::string_view name;
  FormatKind kind;
  std::string_view description;
};

/// In the order of Format.
constexpr std::array kFormats = {
    FormatFacts{Format::kMat, "mat", FormatKind::kBeams, "a log of beams (.mat)"},
    FormatFacts{Format::kCsv, "csv", FormatKind::kBeams, "a log of beams (.csv)"},
    FormatFacts{Format::kPingViewer, "pingviewer", FormatKind::kBeams, "a log of beams (Ping Viewer)"},
    FormatFacts{Format::kPingText, "pingtext", FormatKind::kBeams, "a log of beams (print of a Ping360's pings)"},
    FormatFacts{Format::kSonarView, "svlog", FormatKind::kBeams, "a log of beams (SonarView)"},
    FormatFacts{Format::kSeanetCapture, "seanet", FormatKind::kBeams, "a log of beams (SeaNet, serial line)"},
    FormatFacts{Format::kUdpCapture, "seanet-udp", FormatKind::kBeams, "a log of beams (SeaNet, UDP packets)"},
    FormatFacts{Format::kV4log, "v4log", FormatKind::kBeams, "a log of beams (.v4log)"},
    FormatFacts{Format::kDumplog, "dumplog", FormatKind::kBeams, "a log of beams (SeanetDumpLog)"},
    FormatFacts{Format::kRosBag, "bag", FormatKind::kBeams, "a ROS bag (.bag)"},
    FormatFacts{Format::kRosSqlite, "db3", FormatKind::kBeams, "a ROS bag (.db3)"},
    FormatFacts{Format::kMcap, "mcap", FormatKind::kBeams, "a bag (.mcap)"},
    FormatFacts{Format::kIctineuBeams, "ictineu-is", FormatKind::kBeams, "a log of beams (Ictineu)"},
    FormatFacts{Format::kBeamHits, "hits", FormatKind::kBeams, "a log of beams (bins that were hit)"},
    FormatFacts{Format::kScanGraph, "graph", FormatKind::kScans, "a log of point scans (.graph)"},
    FormatFacts{Format::kScanLog, "log", FormatKind::kScans, "a log of point scans (.log)"},
    FormatFacts{Format::kXtf, "xtf", FormatKind::kScans, "a log of point scans (.xtf)"},
    FormatFacts{Format::kBt, "bt", FormatKind::kMap, "a map (.bt)"},
    FormatFacts{Format::kOt, "ot", FormatKind::kMap, "a map (.ot)"},
    FormatFacts{Format::kPvx, "pvx", FormatKind::kMap, "a map (.pvx)"},
    FormatFacts{Format::kTum, "tum", FormatKind::kTrajectory, "a trajectory (.tum)"},
    FormatFacts{Format::kTlog, "tlog", FormatKind::kNav, "a navigation log (.tlog)"},
    FormatFacts{Format::kDataflash, "dataflash", FormatKind::kNav, "a navigation log (.dataflash)"},
    FormatFacts{Format::kIctineu, "ictineu", FormatKind::kNav, "a navigation log (Ictineu)"},
    FormatFacts{Format::kDvlA50, "a50", FormatKind::kNav, "a navigation log (Water Linked DVL)"},
    FormatFacts{Format::kNmea, "nmea", FormatKind::kNav, "a navigation log (NMEA 0183)"},
    FormatFacts{Format::kNavCsv, "csv", FormatKind::kNav, "a navigation log (.csv)"},
    FormatFacts{Format::kPly, "ply", FormatKind::kCloud, "a cloud of points (.ply)"},
    FormatFacts{Format::kPcd, "pcd", FormatKind::kCloud, "a cloud of points (.pcd)"},
    FormatFacts{Format::kXyz, "xyz", FormatKind::kCloud, "a cloud of points (.xyz)"},
    FormatFacts{Format::kPlyMesh, "ply", FormatKind::kMesh, "a mesh (.ply)"},
    FormatFacts{Format::kOff, "off", FormatKind::kMesh, "a mesh (.off)"},
    FormatFacts{Format::kStl, "stl", FormatKind::kMesh, "a mesh (.stl)"},
    FormatFacts{Format::kLas, "las", FormatKind::kCloud, "a cloud of points (.las)"},
    FormatFacts{Format::kGlb, "glb", FormatKind::kMesh, "a mesh (.glb)"},
    FormatFacts{Format::kGeoJson, "geojson", FormatKind::kTrajectory, "a trajectory (.geojson)"},
    FormatFacts{Format::kGrid, "pgm", FormatKind::kGrid, "a grid (.pgm)"},
    FormatFacts{Format::kAsc, "asc", FormatKind::kGrid, "a grid (.asc)"},
    FormatFacts{Format::kTif, "tif", FormatKind::kGrid, "a grid (.tif)"},
    FormatFacts{Format::kPng, "png", FormatKind::kPicture, "a picture (.png)"},
};
static_assert(std::ranges::all_of(kFormats, [i = 0](const FormatFacts& facts) mutable {
  return facts.format == static_cast<Format>(i++);
}));

const FormatFacts& facts_of(Format format) {
  return kFormats[static_cast<std::size_t>(format)];
}

}  // namespace

FormatKind kind_of(Format format) {
  return facts_of(format).kind;
}

bool is_bag(Format format) {
  return format == Format::kRosBag || format == Format::kRosSqlite || format == Format::kMcap;
}

std::string_view name_of(Format format) {
  return facts_of(format).name;
}

std::string_view description_of(Format format) {
  return facts_of(format).description;
}

std::optional<Format> format_of(std::span<const std::uint8_t> bytes) {
  const std::string_view text = text_of(bytes);
  if (text.starts_with("# Octomap OcTree binary file")) return Format::kBt;
  if (text.starts_with("# Octomap OcTree file")) return Format::kOt;
  if (text.starts_with("PINGVOXM")) return Format::kPvx;
  if (const auto streamed = streamed_format_of(bytes.first(std::min(bytes.size(), ByteStream::kBeginning)))) {
    return streamed;
  }
  if (looks_like_dataflash(bytes)) return Format::kDataflash;
  if (looks_like_tlog(bytes)) return Format::kTlog;
  if (looks_like_ictineu(bytes)) return Format::kIctineu;
  if (looks_like_beam_hits(bytes)) return Format::kBeamHits;
  if (looks_like_a50(bytes)) return Format::kDvlA50;
  if (looks_like_nav_csv(bytes)) return Format::kNavCsv;
  if (looks_like_ply(bytes)) return is_ply_with_faces(bytes) ? Format::kPlyMesh : Format::kPly;
  if (looks_like_pcd(bytes)) return Format::kPcd;
  if (looks_like_xtf(bytes)) return Format::kXtf;
  if (looks_like_mat(bytes)) return Format::kMat;
  if (looks_like_oldest_bt(bytes)) return Format::kBt;
  if (looks_like_scan_graph(bytes)) return Format::kScanGraph;
  if (looks_like_scan_log(bytes)) return Format::kScanLog;
  if (looks_like_csv(bytes)) return Format::kCsv;
  if (looks_like_nmea(bytes)) return Format::kNmea;
  if (looks_like_off(bytes)) return Format::kOff;
  if (looks_like_binary_stl(bytes) || looks_like_stl_text(bytes)) return Format::kStl;
  if (looks_like_tum(bytes)) return Format::kTum;
  if (looks_like_xyz(bytes)) return Format::kXyz;
  return std::nullopt;
}

std::optional<Format> streamed_format_of(std::span<const std::uint8_t> beginning) {
  if (looks_like_ros1_bag(beginning)) return Format::kRosBag;
  if (looks_like_sqlite(beginning)) return Format::kRosSqlite;
  if (looks_like_mcap(beginning)) return Format::kMcap;
  if (looks_like_ping_viewer(beginning)) return Format::kPingViewer;
  if (looks_like_v4log(beginning)) return Format::kV4log;
  if (looks_like_dumplog(beginning)) return Format::kDumplog;
  if (looks_like_udp_capture(beginning)) return Format::kUdpCapture;
  if (looks_like_ping_text(beginning)) return Format::kPingText;
  // These have no magic number: other files may contain such bytes, but not at their beginning.
  if (looks_like_cut_ping_viewer(beginning)) return Format::kPingViewer;
  if (looks_like_sonarview(beginning)) return Format::kSonarView;
  if (looks_like_seanet_capture(beginning)) return Format::kSeanetCapture;
  if (looks_like_ictineu_beams(beginning)) return Format::kIctineuBeams;
  return std::nullopt;
}

bool may_be_known(std::span<const std::uint8_t> beginning) {
  return format_of(beginning) || may_begin_binary_stl(beginning);
}

std::optional<Format> format_for_writing(std::string_view path) {
  constexpr std::array kSuffixes = {
      std::pair{std::string_view(".bt"), Format::kBt},           std::pair{std::string_view(".ot"), Format::kOt},
      std::pair{std::string_view(".pvx"), Format::kPvx},         std::pair{std::string_view(".ply"), Format::kPly},
      std::pair{std::string_view(".pcd"), Format::kPcd},         std::pair{std::string_view(".csv"), Format::kCsv},
      std::pair{std::string_view(".pgm"), Format::kGrid},        std::pair{std::string_view(".yaml"), Format::kGrid},
      std::pair{std::string_view(".asc"), Format::kAsc},         std::pair{std::string_view(".png"), Format::kPng},
      std::pair{std::string_view(".xyz"), Format::kXyz},         std::pair{std::string_view(".tum"), Format::kTum},
      std::pair{std::string_view(".las"), Format::kLas},         std::pair{std::string_view(".glb"), Format::kGlb},
      std::pair{std::string_view(".geojson"), Format::kGeoJson}, std::pair{std::string_view(".mcap"), Format::kMcap},
      std::pair{std::string_view(".tif"), Format::kTif},         std::pair{std::string_view(".tiff"), Format::kTif}};
  const auto same = [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; };
  for (const auto& [suffix, format] : kSuffixes) {
    if (path.size() < suffix.size()) continue;
    const std::string_view end = path.substr(path.size() - suffix.size());
    if (std::equal(end.begin(), end.end(), suffix.begin(), same)) return format;
  }
  return std::nullopt;
}

}  // namespace pingvox
