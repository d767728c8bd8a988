#pragma once

#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "pingvox/result.hpp"

namespace pingvox::detail {

/// The error for the exception that is being handled. What memory ran out for, and a length that no container can have,
/// is kNoMemory; an error of the operating system (a thread that does not start, a file system) is kIo; any other is a
/// mistake of ours, kUnsupported. The last two say what was thrown.
/// REQUIRES to be called where a std::exception is caught.
/// @param name  of what is read or written, which the message begins with; empty: none
inline Error error_of_exception(std::string_view name) {
  const auto no_memory = [] { return Error{Error::Code::kNoMemory, "out of memory"}; };  // so short that it needs none
  try {
    Error error{};
    try {
      throw;
    } catch (const std::bad_alloc&) {
      error = no_memory();
    } catch (const std::length_error&) {
      error = no_memory();
    } catch (const std::system_error& thrown) {
      error = {Error::Code::kIo, thrown.what()};
    } catch (const std::exception& thrown) {
      error = {Error::Code::kUnsupported, std::string("internal error: ") + thrown.what()};
    }
    if (!name.empty()) error.message = std::string(name) + ": " + error.message;
    return error;
  } catch (const std::bad_alloc&) {  // there is too little for the message, too
    return no_memory();
  }
}

/// Calls f, which returns a Result, and returns error_of_exception of what it throws.
template <class F>
auto without_exceptions(F&& f) -> decltype(f()) {
  try {
    return std::forward<F>(f)();
  } catch (const std::exception&) {
    return tl::unexpected(error_of_exception({}));
  }
}

/// The same, with the name of what is read or written in the message.
template <class F>
auto without_exceptions(const std::string& name, F&& f) -> decltype(f()) {
  try {
    return std::forward<F>(f)();
  } catch (const std::exception&) {
    return tl::unexpected(error_of_exception(name));
  }
}

}  // namespace pingvox::detail
