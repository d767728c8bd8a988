#include "pingvox/io/format.hpp"

namespace pingvox {

FormatKind kind_of(Format format) {
  switch (format) {
    case Format::kMat:
    case Format::kCsv:
      return FormatKind::kBeams;
    case Format::kScanGraph:
    case Format::kScanLog:
      return FormatKind::kScans;
    case Format::kBt:
    case Format::kOt:
    case Format::kPvx:
      return FormatKind::kMap;
    case Format::kTum:
      return FormatKind::kTrajectory;
    case Format::kPly:
      return FormatKind::kCloud;
    case Format::kPng:
      break;
  }
  return FormatKind::kPicture;
}

}  // namespace pingvox
