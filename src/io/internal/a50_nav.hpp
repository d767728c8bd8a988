#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pingvox/nav/nav_log.hpp"

namespace pingvox {

/// Parses the JSON lines that a Water Linked DVL A50 or A125 sends on its TCP port (docs/formats.md).
class A50Nav {
 public:
  A50Nav();
  A50Nav(A50Nav&&) noexcept;
  A50Nav& operator=(A50Nav&&) noexcept;
  ~A50Nav();

  /// @param received_s  on the clock that times are wanted on
  /// @return one sample of each quantity in the line; nullopt: the line is damaged
  std::optional<std::vector<NavSource>> add(std::string_view line, double received_s);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A line of JSON with the member "timestamp" in front, which readers take for the time when the line was received; a
/// line that is no object as it is.
/// @param received_s  since 1970
std::string with_timestamp(std::string_view line, double received_s);

}  // namespace pingvox
