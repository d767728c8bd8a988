#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "pingvox/io/bytes.hpp"

namespace pingvox {

/// The kinds of files that we know.
enum class Format {
  kMat,        ///< MATLAB 5: beams
  kCsv,        ///< beams as text (docs/formats.md)
  kScanGraph,  ///< OctoMap's binary scan graph: point scans
  kScanLog,    ///< OctoMap's text form of it, NODE x y z roll pitch yaw: point scans
  kBt,         ///< OctoMap's binary tree: occupied or free
  kOt,         ///< OctoMap's tree with log-odds
  kPvx,        ///< our own map: any depth, log-odds, how it was made (docs/formats.md)
  kTum,        ///< a trajectory
  kPly,        ///< points, written only
  kPng,        ///< pictures, written only
};

enum class FormatKind { kBeams, kScans, kMap, kTrajectory, kCloud, kPicture };

FormatKind kind_of(Format format);
/// Short lower-case name, as in "csv".
std::string_view name_of(Format format);

/// Told by content, not by name. nullopt: none of those that we read.
std::optional<Format> format_of(std::span<const std::uint8_t> bytes);

/// What a file that is to be written is by its suffix (.bt .ot .pvx .ply .csv .png); nullopt: none that we write.
std::optional<Format> format_for_writing(std::string_view path);

}  // namespace pingvox
