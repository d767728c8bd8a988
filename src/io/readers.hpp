#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pingvox/io/beams.hpp"
#include "pingvox/io/byte_stream.hpp"
#include "pingvox/io/bytes.hpp"

// One reader per format, for open_beams, open_scans and read_mesh, and its test of content, for format_of.
namespace pingvox {

bool looks_like_mat(std::span<const std::uint8_t> bytes);
Result<std::unique_ptr<BeamSource>> open_mat(FileBytes file, Damage damage);

bool looks_like_csv(std::span<const std::uint8_t> bytes);
Result<std::unique_ptr<BeamSource>> open_csv(FileBytes file, Damage damage);

bool looks_like_beam_hits(std::span<const std::uint8_t> bytes);
Result<std::unique_ptr<BeamSource>> open_beam_hits(const FileBytes& file, Damage damage);
/// The files of times in the folder of such a log; there has to be one.
std::vector<std::string> times_beside_hits(const std::string& log);

// Logs that are read as streams, recognised by their beginning.
bool looks_like_ping_viewer(std::span<const std::uint8_t> beginning);
/// Whether it begins within a record, behind the header.
bool looks_like_cut_ping_viewer(std::span<const std::uint8_t> beginning);
Result<std::unique_ptr<BeamSource>> open_ping_viewer(ByteStream stream, Damage damage);

bool looks_like_ping_text(std::span<const std::uint8_t> beginning);
Result<std::unique_ptr<BeamSource>> open_ping_text(ByteStream stream, Damage damage);

bool looks_like_sonarview(std::span<const std::uint8_t> beginning);
Result<std::unique_ptr<BeamSource>> open_sonarview(ByteStream stream, Damage damage);

bool looks_like_seanet_capture(std::span<const std::uint8_t> beginning);
Result<std::unique_ptr<BeamSource>> open_seanet_capture(ByteStream stream, Damage damage);

bool looks_like_udp_capture(std::span<const std::uint8_t> beginning);
Result<std::unique_ptr<BeamSource>> open_udp_capture(ByteStream stream, Damage damage);

bool looks_like_v4log(std::span<const std::uint8_t> beginning);
Result<std::unique_ptr<BeamSource>> open_v4log(ByteStream stream, Damage damage);

bool looks_like_ictineu_beams(std::span<const std::uint8_t> beginning);
Result<std::unique_ptr<BeamSource>> open_ictineu_beams(ByteStream stream, Damage damage);

bool looks_like_dumplog(std::span<const std::uint8_t> beginning);
Result<std::unique_ptr<BeamSource>> open_dumplog(ByteStream stream, Damage damage);

/// A ROS bag, as open_bag_log(). Unlike with other logs, an error when there is nothing to map.
Result<BagLog> open_any_bag(ByteStream stream, Damage damage, const BeamTopic& topic);

bool looks_like_scan_graph(std::span<const std::uint8_t> bytes);
Result<std::unique_ptr<ScanSource>> open_scan_graph(FileBytes file, Damage damage);

bool looks_like_scan_log(std::span<const std::uint8_t> bytes);
Result<std::unique_ptr<ScanSource>> open_scan_log(FileBytes file, Damage damage);

bool looks_like_xtf(std::span<const std::uint8_t> bytes);
Result<std::unique_ptr<ScanSource>> open_xtf(FileBytes file, Damage damage);

bool looks_like_tum(std::span<const std::uint8_t> bytes);

/// Clouds are one scan. Origin of the rays (map frame); nullopt: that of the file, else 0, 0, 0.
using CloudOrigin = std::optional<Eigen::Vector3d>;

Result<std::unique_ptr<ScanSource>> open_ply_cloud(FileBytes file, Damage damage, const CloudOrigin& origin_m);

bool looks_like_pcd(std::span<const std::uint8_t> bytes);
Result<std::unique_ptr<ScanSource>> open_pcd(FileBytes file, Damage damage, const CloudOrigin& origin_m);

bool looks_like_xyz(std::span<const std::uint8_t> bytes);
Result<std::unique_ptr<ScanSource>> open_xyz(FileBytes file, Damage damage, const CloudOrigin& origin_m);

bool looks_like_off(std::span<const std::uint8_t> bytes);
bool looks_like_binary_stl(std::span<const std::uint8_t> bytes);
/// Whether a longer file with these first bytes may be a binary STL, which only its size proves.
bool may_begin_binary_stl(std::span<const std::uint8_t> beginning);
bool looks_like_stl_text(std::span<const std::uint8_t> bytes);

/// What a reader skipped because it was damaged.
struct SkippedRecords {
  std::size_t count = 0;
  std::string first;  ///< place and reason of the first one
};

/// Handles a damaged record: counts it, or returns an error with Damage::kFail.
Result<void> handle_damage(Damage damage, SkippedRecords& skipped, const std::string& file, const std::string& place,
                           const std::string& reason);
/// The same of a log that is read as a stream, whose damage is counted by kind.
Result<void> handle_damage(Damage damage, std::vector<DamageKind>& kinds, std::string_view kind,
                           const std::string& file, std::uint64_t at_byte, std::string_view reason);

/// Fraction read when `left` of `all` remain.
inline double read_share(std::uint64_t left, std::uint64_t all) {
  return all > 0 ? 1.0 - static_cast<double>(left) / static_cast<double>(all) : 1.0;
}

}  // namespace pingvox
