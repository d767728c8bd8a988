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
  /// Logs are reduced until the page is not larger, as far as that helps.
  std::size_t wanted_bytes = 1'400'000;

  Result<void> validate() const;  ///< kBadOption when nothing is wanted
};

/// Writes a page with all of a scene in it, which needs no server: data, script and style are within the HTML.
/// @return kLimit for a map of too many cells; kIo when `out` fails
Result<void> write_page(Scene scene, const Page& page, std::ostream& out, const ExportOptions& options = {});

}  // namespace pingvox::web
