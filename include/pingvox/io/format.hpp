#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "pingvox/io/bytes.hpp"

namespace pingvox {

/// Known file formats.
enum class Format {
  kMat,            ///< MATLAB 5: beams
  kCsv,            ///< beams as text (docs/formats.md)
  kPingViewer,     ///< Ping Viewer's log of a Ping360: beams
  kPingText,       ///< pings of a Ping360 as Blue Robotics' Python library prints them: beams
  kSonarView,      ///< log of SonarView, or capture of the line of a Ping360: beams
  kSeanetCapture,  ///< capture of the serial line of a SeaNet head: beams
  kUdpCapture,     ///< the same in UDP packets as hexadecimal text: beams
  kV4log,          ///< log of Tritech's program: beams
  kDumplog,        ///< text that SeanetDumpLog makes of a V4LOG: beams
  kRosBag,         ///< bag of ROS 1: beams, navigation, or both
  kRosSqlite,      ///< bag of ROS 2 as an SQLite database: the same
  kMcap,           ///< bag of ROS 2 as MCAP: the same
  kIctineuBeams,   ///< log of the imaging sonar of the vehicle Ictineu, as text: beams
  kBeamHits,       ///< bins that were hit, as text, and the times of the beams in a file beside it: beams
  kScanGraph,      ///< OctoMap's binary scan graph: point scans
  kScanLog,        ///< OctoMap's scan graph as text, NODE x y z roll pitch yaw: point scans
  kXtf,            ///< line of a multibeam in Triton's eXtended Format: point scans
  kBt,             ///< OctoMap's binary tree: occupied or free
  kOt,             ///< OctoMap's tree with log-odds
  kPvx,            ///< pingvox map: any depth, log-odds, options (docs/formats.md)
  kTum,            ///< a trajectory
  kTlog,           ///< MAVLink telemetry log of a ground station: navigation
  kDataflash,      ///< log that an ArduPilot autopilot keeps: navigation
  kIctineu,        ///< DVL, MTi or DGPS log of the vehicle Ictineu, as text: navigation
  kDvlA50,         ///< lines of a Water Linked DVL, JSON or serial: navigation
  kNmea,           ///< NMEA 0183: navigation
  kNavCsv,         ///< navigation as text (docs/formats.md)
  kPly,            ///< a cloud of points
  kPcd,            ///< a cloud of points, PCL's
  kXyz,            ///< a cloud of points as text
  kPlyMesh,        ///< PLY with faces: a mesh
  kOff,            ///< a mesh, read only
  kStl,            ///< a mesh, read only
  kLas,            ///< a cloud of points as laser scanners give it, written only
  kGlb,            ///< a mesh with colours, binary glTF, written only
  kGeoJson,        ///< a trajectory on the earth, written only
  kGrid,           ///< a slice of a map for ROS's map_server, written only: a picture (PGM) and a YAML file beside it
  kAsc,            ///< a map seen from above as an ESRI ASCII grid, written only
  kTif,            ///< the same as GeoTIFF, written only
  kPng,            ///< pictures, written only
};

enum class FormatKind { kBeams, kScans, kMap, kTrajectory, kNav, kCloud, kMesh, kGrid, kPicture };

/// Bags are of the kind kBeams, though they may hold navigation only (see read_bag).
FormatKind kind_of(Format format);
/// Whether it is one of the bags of ROS.
bool is_bag(Format format);
/// Short lower-case name, as in "csv".
std::string_view name_of(Format format);
/// As in "a log of beams (Ping Viewer)".
std::string_view description_of(Format format);

/// Format by content, not by name (docs/formats.md gives the order). nullopt: unknown file.
std::optional<Format> format_of(std::span<const std::uint8_t> bytes);

/// The same for logs that are read as streams, by ByteStream::beginning() alone. nullopt: another format, or unknown.
std::optional<Format> streamed_format_of(std::span<const std::uint8_t> beginning);
/// Whether a file that goes on after these first bytes (ByteStream::kBeginning of them) may be of a known format.
bool may_be_known(std::span<const std::uint8_t> beginning);

/// Format of a file to write, by its suffix (.bt .ot .pvx .ply .pcd .xyz .las .glb .csv .tum .geojson .mcap
/// .pgm .yaml .asc .tif .tiff .png); nullopt: none that can be written.
std::optional<Format> format_for_writing(std::string_view path);

}  // namespace pingvox
