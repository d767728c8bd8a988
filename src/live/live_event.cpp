#include "pingvox/live/live_event.hpp"

namespace pingvox {

const Error* error_of(const LiveEvent& event) {
  return std::visit(
      [](const auto& one) -> const Error* {
        if constexpr (requires { one.error; }) return &one.error;
        return nullptr;
      },
      event);
}

}  // namespace pingvox
