#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <string>

#include "pingvox/io/bytes.hpp"
#include "pingvox/result.hpp"

namespace pingvox {

/// Reads a whole file, or standard input for "-". kIo: not found, no permission, a directory; the message names it.
Result<FileBytes> read_file(const std::string& path);

/// Writes a temporary file and renames it into place when it is complete and on disk: on failure the old file stays and
/// the temporary one is removed. Those of killed processes are removed when the same file is written again. Several
/// processes may write it at once: the last one wins. "-" writes to standard output.
/// @param write  writes the content; its error is passed on
/// @return kIo when the operating system reports an error (no permission, disk full)
Result<void> write_file(const std::string& path, const std::function<Result<void>(std::ostream&)>& write);

}  // namespace pingvox
