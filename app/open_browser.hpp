#pragma once

#include <string>
#include <string_view>

#include "pingvox/result.hpp"
#include "pingvox/web/page.hpp"

namespace pingvox::app {

/// Opens an address in the user's browser, where there is a screen and xdg-open. Errors are ignored: the address is on
/// the terminal, too.
void open_browser(const std::string& url);

/// The page that is built in. @return kUnsupported, with what to install, where there is none
Result<web::Page> page_of_build(std::string_view command);

}  // namespace pingvox::app
