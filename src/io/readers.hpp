#pragma once

#include <memory>
#include <span>
#include <string>

#include "pingvox/io/beams.hpp"
#include "pingvox/io/bytes.hpp"

// The readers behind open_beams and open_scans, and how format_of knows their formats.
namespace pingvox {

bool looks_like_mat(std::span<const std::uint8_t> bytes);
Result<std::unique_ptr<BeamSource>> open_mat(FileBytes file, Damage damage);

bool looks_like_csv(std::span<const std::uint8_t> bytes);
Result<std::unique_ptr<BeamSource>> open_csv(FileBytes file, Damage damage);

bool looks_like_scan_graph(std::span<const std::uint8_t> bytes);
Result<std::unique_ptr<ScanSource>> open_scan_graph(FileBytes file, Damage damage);

bool looks_like_scan_log(std::span<const std::uint8_t> bytes);
Result<std::unique_ptr<ScanSource>> open_scan_log(FileBytes file, Damage damage);

bool looks_like_tum(std::span<const std::uint8_t> bytes);

/// What happened to a damaged piece of a log: nothing (it is counted) or, with Damage::kFail, the error.
Result<void> skipped_or_failed(Damage damage, std::size_t& skipped, const std::string& file, const std::string& place,
                               const std::string& reason);

}  // namespace pingvox
