#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <string>

#include "pingvox/io/bytes.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Reads a whole file, or standard input for "-". kIo: not there, no right, a directory; the message names it.
Result<FileBytes> read_file(const std::string& path);

/// Writes a file beside its name and renames it into place when it is complete and on disk: whatever goes wrong, the
/// old file stays as it was and nothing is left beside it. What a killed process left there is removed when the same
/// file is written again; processes that write it at once do not disturb each other: the last one's stays. "-" writes
/// to standard output.
/// @param write  writes the content; its error is passed on
/// @return kIo when the operating system refuses (no right, disk full)
Result<void> write_file(const std::string& path, const std::function<Result<void>(std::ostream&)>& write);

}  // namespace pingvox
