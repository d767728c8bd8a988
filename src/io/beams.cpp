#include "pingvox/io/beams.hpp"

#include <fmt/core.h>

#include <optional>
#include <string_view>

#include "io/readers.hpp"
#include "pingvox/io/format.hpp"

namespace pingvox {
namespace {

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
