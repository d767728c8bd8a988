#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace pingvox {

/// Why something that may fail did: one sentence for a person, naming file, place and reason where they exist.
struct Error {
  enum class Code {
    kBadOption,    ///< the caller's options do not make sense
    kIo,           ///< the operating system refused: no such file, no right, disk full
    kCorrupt,      ///< the bytes are not what their format promises
    kUnsupported,  ///< well-formed, but nothing that this version (or this format) can hold
    kLimit,        ///< a limit that the caller set would be passed; what it is for was not changed
    kNoMemory,     ///< memory ran out; what was changed until then, the function's comment says
  } code;
  std::string message;
};

/// The value, or why there is none. A function that returns a Result throws nothing; the others throw nothing but
/// std::bad_alloc, as containers of the standard library do.
template <class T>
using Result = tl::expected<T, Error>;

/// Shorthand for returning an error from a function that returns a Result.
inline tl::unexpected<Error> fail(Error::Code code, std::string message) {
  return tl::unexpected<Error>(Error{code, std::move(message)});
}

}  // namespace pingvox
