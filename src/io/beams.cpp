#include "pingvox/io/beams.hpp"

#include <fmt/core.h>

#include <optional>
#include <string_view>

#include "io/readers.hpp"
#include "pingvox/io/format.hpp"

namespace pingvox {
namespace {

std::string_view description_of(Format format) {
  switch (format) {
    case Format::kMat:
      return "a MATLAB file of beams";
    case Format::kCsv:
      return "a CSV file of beams";
    case Format::kPingViewer:
      return "a log of Ping Viewer";
    case Format::kPingText:
      return "a print of pings";
    case Format::kSonarView:
      return "a log of SonarView";
    case Format::kSeanetCapture:
    case Format::kUdpCapture:
      return "a capture of a SeaNet sonar";
    case Format::kV4log:
    case Format::kDumplog:
      return "a SeaNet log";
    case Format::kRosBag:
    case Format::kRosSqlite:
    case Format::kMcap:
      return "a ROS bag";
    case Format::kBeamHits:
      return "a list of hits";
    case Format::kScanGraph:
      return "an OctoMap scan graph";
    case Format::kScanLog:
      return "an OctoMap scan log";
    case Format::kXtf:
      return "a line of a multibeam";
    case Format::kBt:
      return "an OctoMap binary tree";
    case Format::kOt:
      return "an OctoMap tree";
    case Format::kPvx:
      return "a pingvox map";
    case Format::kTum:
      return "a trajectory";
    case Format::kTlog:
    case Format::kDataflash:
    case Format::kIctineu:
    case Format::kDvlA50:
    case Format::kNmea:
    case Format::kNavCsv:
      return "a navigation log";
    case Format::kPly:
    case Format::kPcd:
    case Format::kXyz:
      return "a point cloud";
    case Format::kPlyMesh:
    case Format::kOff:
    case Format::kStl:
      return "a mesh";
    case Format::kGrid:
    case Format::kAsc:
      return "a grid";
    case Format::kPng:
      break;
  }
  return "a picture";
}

tl::unexpected<Error> wrong_format(const std::string& name, std::string_view wanted, std::optional<Format> format) {
  return fail(Error::Code::kUnsupported,
              format ? fmt::format("{}: not {} (it is {})", name, wanted, description_of(*format))
                     : fmt::format("{}: not {} that we know", name, wanted));
}

}  // namespace

Result<std::unique_ptr<BeamSource>> open_beams(ByteStream stream, Damage damage, const BeamTopic& topic) {
  const std::optional<Format> streamed = streamed_format_of(stream.beginning());
  if (streamed && is_bag(*streamed)) return open_bag_beams(std::move(stream), damage, topic);
  if (streamed == Format::kPingViewer) return open_ping_viewer(std::move(stream), damage);
  if (streamed == Format::kPingText) return open_ping_text(std::move(stream), damage);
  if (streamed == Format::kSonarView) return open_sonarview(std::move(stream), damage);
  if (streamed == Format::kSeanetCapture) return open_seanet_capture(std::move(stream), damage);
  if (streamed == Format::kUdpCapture) return open_udp_capture(std::move(stream), damage);
  if (streamed == Format::kV4log) return open_v4log(std::move(stream), damage);
  if (streamed == Format::kDumplog) return open_dumplog(std::move(stream), damage);
  Result<FileBytes> whole = ByteStream::whole(std::move(stream));
  if (!whole) return tl::unexpected(whole.error());
  FileBytes& file = *whole;
  const std::optional<Format> format = format_of(file.view());
  if (format == Format::kMat) return open_mat(std::move(file), damage);
  if (format == Format::kCsv) return open_csv(std::move(file), damage);
  if (format == Format::kBeamHits) return open_beam_hits(file, damage);
  if (file.bytes.empty()) return fail(Error::Code::kUnsupported, fmt::format("{}: is empty", file.name));
  return wrong_format(file.name, "a log of beams", format);
}

Result<std::unique_ptr<BeamSource>> open_beams(FileBytes file, Damage damage, const BeamTopic& topic) {
  return open_beams(ByteStream(std::move(file)), damage, topic);
}

Result<std::unique_ptr<ScanSource>> open_scans(FileBytes file, Damage damage,
                                               const std::optional<Eigen::Vector3d>& cloud_origin_m) {
  const std::optional<Format> format = format_of(file.view());
  if (format == Format::kScanGraph) return open_scan_graph(std::move(file), damage);
  if (format == Format::kScanLog) return open_scan_log(std::move(file), damage);
  if (format == Format::kXtf) return open_xtf(std::move(file), damage);
  if (format == Format::kPly) return open_ply_cloud(std::move(file), damage, cloud_origin_m);
  if (format == Format::kPcd) return open_pcd(std::move(file), damage, cloud_origin_m);
  if (format == Format::kXyz) return open_xyz(std::move(file), damage, cloud_origin_m);
  if (file.bytes.empty()) return fail(Error::Code::kUnsupported, fmt::format("{}: is empty", file.name));
  return wrong_format(file.name, "a log of scans", format);
}

Result<void> handle_damage(Damage damage, SkippedRecords& skipped, const std::string& file, const std::string& place,
                           const std::string& reason) {
  if (skipped.count++ == 0) skipped.first = fmt::format("{}: {}", place, reason);
  if (damage == Damage::kSkip) return {};
  return fail(Error::Code::kCorrupt, fmt::format("{}: {}: {}", file, place, reason));
}

}  // namespace pingvox
