#pragma once

#include <exception>
#include <utility>

#include "pingvox/result.hpp"

namespace pingvox::detail {

/// Calls f, which returns a Result. Nothing here throws but what runs out of memory, OpenCV's filters included.
template <class F>
auto without_exceptions(F&& f) -> decltype(f()) {
  try {
    return std::forward<F>(f)();
  } catch (const std::exception&) {
    return fail(Error::Code::kNoMemory, "out of memory");  // so short that it needs none
  }
}

}  // namespace pingvox::detail
