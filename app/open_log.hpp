#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>

#include "pingvox/io/bag.hpp"
#include "pingvox/io/beams.hpp"
#include "pingvox/io/byte_stream.hpp"
#include "pingvox/io/bytes.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/io/input_file.hpp"
#include "pingvox/io/open_log.hpp"
#include "pingvox/result.hpp"

namespace pingvox::app {

/// The kind in the words of Option::only_for: "logs of beams".
std::string kind_text(FormatKind kind);

/// Adds to an error of open_log what to do with a file of this format.
Error advise_on_log(Error error, Format format);
/// pingvox::open_log, with advice in its errors.
Result<Log> open_file_log(ByteStream stream, Damage damage, const BeamTopic& topic);

/// Reads a file that may be a log. Of a ROS bag it reads only the beginning, which is enough to identify the format: a
/// bag may consist of several files, so it is opened by its path later.
Result<FileBytes> read_input(const std::string& path);
/// The file at `path` for a recording, by what `read_input` returned.
InputFile input_file(FileBytes file, const std::string& path);
/// The log in the file at `path`, by what `read_input` returned. @see open_file_log
Result<Log> open_input(FileBytes file, const std::string& path, Damage damage, const BeamTopic& topic);

/// Whether a bag has messages that are read as `use`.
bool has(const BagContents& bag, BagTopicSummary::Use use);

/// The beams of the log at `path` less its own background nearer than `range_m`. nullopt: as they are.
/// @return as for learn_background
Result<std::unique_ptr<BeamSource>> subtract_own_background(std::unique_ptr<BeamSource> beams, const std::string& path,
                                                            std::optional<double> range_m, Damage damage,
                                                            const BeamTopic& topic);

}  // namespace pingvox::app
