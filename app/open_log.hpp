#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "pingvox/io/beams.hpp"
#include "pingvox/io/byte_stream.hpp"
#include "pingvox/io/bytes.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/result.hpp"

namespace pingvox::app {

/// What a file is, by its content. kUnsupported when it is nothing that we read; the message names it.
Result<Format> recognised(const FileBytes& file);
/// The same. What is not read as a stream is in memory afterwards.
Result<Format> recognised(ByteStream& stream);

/// A format with its kind, for messages: "a map (.bt)".
std::string described(Format format);

/// A log of either kind.
using Log = std::variant<std::unique_ptr<BeamSource>, std::unique_ptr<ScanSource>>;

/// Any log or cloud, told by content. kUnsupported when the file is none, with what it is.
/// @param cloud_origin_m  as for open_scans
Result<Log> open_log(ByteStream stream, Damage damage,
                     const std::optional<Eigen::Vector3d>& cloud_origin_m = std::nullopt);

}  // namespace pingvox::app
