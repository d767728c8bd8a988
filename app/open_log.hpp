#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>

#include "pingvox/io/bag.hpp"
#include "pingvox/io/beams.hpp"
#include "pingvox/io/byte_stream.hpp"
#include "pingvox/io/bytes.hpp"
#include "pingvox/io/format.hpp"
#include "pingvox/result.hpp"
#include "pingvox/sonar/background.hpp"

namespace pingvox::app {

/// Format of a file by its content. kUnsupported when it is not readable; the message describes the file.
Result<Format> identify_format(const FileBytes& file);
/// The same. Loads formats that are not read as streams into memory.
Result<Format> identify_format(ByteStream& stream);

/// The kind in the words of Option::only_for: "logs of beams".
std::string kind_text(FormatKind kind);

/// A log of either kind.
using Log = BagLog;

/// Opens a log or cloud by its content. kUnsupported when it is neither; the message describes the file.
/// @param cloud_origin_m  as for open_scans
/// @param topic           as for open_beams
Result<Log> open_log(ByteStream stream, Damage damage,
                     const std::optional<Eigen::Vector3d>& cloud_origin_m = std::nullopt, const BeamTopic& topic = {});

/// The bytes of a file that may be a log. Of a bag only the beginning, which shows its format: `open_input` opens it
/// again, as it may be several files, or have changes beside it.
Result<FileBytes> read_input(const std::string& path);
/// The log in a file that was read by `read_input(path)`. @see open_log
Result<Log> open_input(FileBytes file, const std::string& path, Damage damage, const BeamTopic& topic);

/// The beams of a log. kUnsupported naming it when it holds scans.
Result<std::unique_ptr<BeamSource>> only_beams(Log log, const std::string& name);

/// What a bag holds; the stream can still be read afterwards. A pipe is loaded into memory for that.
/// @param fields  of messages; there must be some of each
Result<BagContents> bag_contents(ByteStream& stream, Damage damage, std::span<const NavFields> fields);
/// Whether it has messages that are read as `use`.
bool has(const BagContents& bag, BagTopicSummary::Use use);

/// What each direction of a dive's logs always hears nearer than `range_m`. Logs of points are passed over.
/// @return kBadOption for standard input, which cannot be read once more; kUnsupported when there are too few beams
Result<Background> learn_background(std::span<const std::string> paths, double range_m, Damage damage,
                                    const BeamTopic& topic);

/// The beams of the log at `path` less its own background nearer than `range_m`. nullopt: as they are.
/// @return as for learn_background
Result<std::unique_ptr<BeamSource>> subtract_own_background(std::unique_ptr<BeamSource> beams, const std::string& path,
                                                            std::optional<double> range_m, Damage damage,
                                                            const BeamTopic& topic);

}  // namespace pingvox::app
