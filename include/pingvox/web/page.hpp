#pragma once

#include <cstddef>
#include <optional>
#include <ostream>
#include <string_view>

#include "pingvox/result.hpp"
#include "pingvox/web/scene.hpp"

namespace pingvox::web {

/// The page as a browser reads it. `html` names the other two as "page.js" and "page.css".
struct Page {
  std::string_view html, script, style;
};

/// The page that is built into the library; nullopt: it was built without (docs/view.md).
std::optional<Page> built_in_page();

struct ExportOptions {
  /// Size to reach by reducing the intensities of logs, where that is enough.
  std::size_t wanted_bytes = 1'400'000;

  Result<void> validate() const;  ///< kBadOption when wanted_bytes is 0
};

/// Writes a scene as one HTML file with data, script and style, which needs no server.
/// @return kLimit for a map of too many cells; kIo when `out` fails
Result<void> write_page(Scene scene, const Page& page, std::ostream& out, const ExportOptions& options = {});

}  // namespace pingvox::web
