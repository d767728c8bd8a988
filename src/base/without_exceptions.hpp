#pragma once

#include <exception>
#include <string>
#include <utility>

#include "pingvox/result.hpp"

namespace pingvox::detail {

/// Calls f, which returns a Result. Nothing throws but what runs out of memory, OpenCV's filters included.
template <class F>
auto without_exceptions(F&& f) -> decltype(f()) {
  try {
    return std::forward<F>(f)();
  } catch (const std::exception&) {
    return fail(Error::Code::kNoMemory, "out of memory");  // so short that it needs none
  }
}

/// The same, with the name of what is read or written in the message.
template <class F>
auto without_exceptions(const std::string& name, F&& f) -> decltype(f()) {
  try {
    return std::forward<F>(f)();
  } catch (const std::exception&) {
    // There may be too little for the name, too.
    return without_exceptions(
        [&]() -> decltype(f()) { return fail(Error::Code::kNoMemory, name + ": out of memory"); });
  }
}

}  // namespace pingvox::detail
