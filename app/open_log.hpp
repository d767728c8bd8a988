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

/// The format of a file, by its content. kUnsupported when we do not read it; the message says what it is.
Result<Format> identify_format(const FileBytes& file);
/// The same. What is not read as a stream is in memory afterwards.
Result<Format> identify_format(ByteStream& stream);

/// A format with its kind, for messages: "a map (.bt)".
std::string describe(Format format);

/// The kind as options name it (Option::only_for): "logs of beams".
std::string kind_text(FormatKind kind);

/// A log of either kind.
using Log = std::variant<std::unique_ptr<BeamSource>, std::unique_ptr<ScanSource>>;

/// Any log or cloud, recognised by content. kUnsupported when the file is none, with what it is.
/// @param cloud_origin_m  as for open_scans
Result<Log> open_log(ByteStream stream, Damage damage,
                     const std::optional<Eigen::Vector3d>& cloud_origin_m = std::nullopt);

}  // namespace pingvox::app
