#pragma once

#include <stdexcept>

namespace pingvox::fuzz {

/// Throws when a promise is broken: nobody catches it in a fuzzer, which is a finding, and a test says which input it
/// was.
inline void require(bool kept, const char* promise) {
  if (!kept) throw std::logic_error(promise);
}

}  // namespace pingvox::fuzz
