#include "pingvox/io/format.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "io/bag.hpp"
#include "io/byte_reader.hpp"
#include "io/nav_readers.hpp"
#include "io/ply_header.hpp"
#include "io/readers.hpp"
#include "io/text.hpp"
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

}  // namespace

FormatKind kind_of(Format format) {
  switch (format) {
    case Format::kMat:
    case Format::kCsv:
    case Format::kPingViewer:
    case Format::kPingText:
    case Format::kSonarView:
    case Format::kSeanetCapture:
    case Format::kUdpCapture:
    case Format::kV4log:
    case Format::kDumplog:
    case Format::kRosBag:
    case Format::kRosSqlite:
    case Format::kMcap:
    case Format::kBeamHits:
      return FormatKind::kBeams;
    case Format::kScanGraph:
    case Format::kScanLog:
    case Format::kXtf:
      return FormatKind::kScans;
    case Format::kBt:
    case Format::kOt:
    case Format::kPvx:
      return FormatKind::kMap;
    case Format::kTum:
      return FormatKind::kTrajectory;
    case Format::kTlog:
    case Format::kDataflash:
    case Format::kIctineu:
    case Format::kDvlA50:
    case Format::kNmea:
    case Format::kNavCsv:
      return FormatKind::kNav;
    case Format::kPly:
    case Format::kPcd:
    case Format::kXyz:
      return FormatKind::kCloud;
    case Format::kPlyMesh:
    case Format::kOff:
    case Format::kStl:
      return FormatKind::kMesh;
    case Format::kGrid:
    case Format::kAsc:
      return FormatKind::kGrid;
    case Format::kPng:
      break;
  }
  return FormatKind::kPicture;
}

bool is_bag(Format format) {
  return format == Format::kRosBag || format == Format::kRosSqlite || format == Format::kMcap;
}

std::string_view name_of(Format format) {
  switch (format) {
    case Format::kMat:
      return "mat";
    case Format::kCsv:
      return "csv";
    case Format::kPingViewer:
      return "pingviewer";
    case Format::kPingText:
      return "pingtext";
    case Format::kSonarView:
      return "svlog";
    case Format::kSeanetCapture:
      return "seanet";
    case Format::kUdpCapture:
      return "seanet-udp";
    case Format::kV4log:
      return "v4log";
    case Format::kDumplog:
      return "dumplog";
    case Format::kRosBag:
      return "bag";
    case Format::kRosSqlite:
      return "db3";
    case Format::kMcap:
      return "mcap";
    case Format::kBeamHits:
      return "hits";
    case Format::kScanGraph:
      return "graph";
    case Format::kScanLog:
      return "log";
    case Format::kXtf:
      return "xtf";
    case Format::kBt:
      return "bt";
    case Format::kOt:
      return "ot";
    case Format::kPvx:
      return "pvx";
    case Format::kTum:
      return "tum";
    case Format::kTlog:
      return "tlog";
    case Format::kDataflash:
      return "dataflash";
    case Format::kIctineu:
      return "ictineu";
    case Format::kDvlA50:
      return "a50";
    case Format::kNmea:
      return "nmea";
    case Format::kNavCsv:
      return "csv";
    case Format::kPly:
    case Format::kPlyMesh:
      return "ply";
    case Format::kPcd:
      return "pcd";
    case Format::kXyz:
      return "xyz";
    case Format::kOff:
      return "off";
    case Format::kStl:
      return "stl";
    case Format::kGrid:
      return "pgm";
    case Format::kAsc:
      return "asc";
    case Format::kPng:
      break;
  }
  return "png";
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
  if (looks_like_sonarview(beginning)) return Format::kSonarView;
  if (looks_like_seanet_capture(beginning)) return Format::kSeanetCapture;
  return std::nullopt;
}

std::optional<Format> format_for_writing(std::string_view path) {
  constexpr std::array kSuffixes = {
      std::pair{std::string_view(".bt"), Format::kBt},    std::pair{std::string_view(".ot"), Format::kOt},
      std::pair{std::string_view(".pvx"), Format::kPvx},  std::pair{std::string_view(".ply"), Format::kPly},
      std::pair{std::string_view(".pcd"), Format::kPcd},  std::pair{std::string_view(".csv"), Format::kCsv},
      std::pair{std::string_view(".pgm"), Format::kGrid}, std::pair{std::string_view(".yaml"), Format::kGrid},
      std::pair{std::string_view(".asc"), Format::kAsc},  std::pair{std::string_view(".png"), Format::kPng},
      std::pair{std::string_view(".xyz"), Format::kXyz},  std::pair{std::string_view(".tum"), Format::kTum}};
  const auto same = [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; };
  for (const auto& [suffix, format] : kSuffixes) {
    if (path.size() < suffix.size()) continue;
    const std::string_view end = path.substr(path.size() - suffix.size());
    if (std::equal(end.begin(), end.end(), suffix.begin(), same)) return format;
  }
  return std::nullopt;
}

}  // namespace pingvox
