#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace pingvox {

/// An error with a message for people that names file, place and reason where they exist.
struct Error {
  enum class Code {
    kBadOption,    ///< invalid options
    kIo,           ///< error of the operating system: file not found, no permission, disk full
    kCorrupt,      ///< data that violate their format
    kUnsupported,  ///< well-formed, but not supported by this version (or format)
    kLimit,        ///< would exceed a limit set by the caller; the target is unchanged
    kNoMemory,     ///< out of memory; the function documents what may have changed
  } code;
  std::string message;
};

/// A value or an error. Functions that return a Result do not throw; others throw nothing but std::bad_alloc, as
/// standard containers do.
template <class T>
using Result = tl::expected<T, Error>;

/// Shorthand for returning an error from a function that returns a Result.
inline tl::unexpected<Error> fail(Error::Code code, std::string message) {
  return tl::unexpected<Error>(Error{code, std::move(message)});
}

}  // namespace pingvox
