#include "pingvox/web/page.hpp"

#ifdef PINGVOX_HAS_PAGE
extern "C" {
// Of the assembler file that holds the page (cmake/pingvox_view.cmake).
extern const char pingvox_page_html[], pingvox_page_html_end[];
extern const char pingvox_page_js[], pingvox_page_js_end[];
extern const char pingvox_page_css[], pingvox_page_css_end[];
}
#endif

namespace pingvox::web {

std::optional<Page> built_in_page() {
#ifdef PINGVOX_HAS_PAGE
  return Page{std::string_view(pingvox_page_html, pingvox_page_html_end),
              std::string_view(pingvox_page_js, pingvox_page_js_end),
              std::string_view(pingvox_page_css, pingvox_page_css_end)};
#else
  return std::nullopt;
#endif
}

}  // namespace pingvox::web
