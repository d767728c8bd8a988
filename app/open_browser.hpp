#pragma once

#include <string>

namespace pingvox::app {

/// Opens an address in the user's browser, where there is a screen and xdg-open. Errors are ignored: the address is on
/// the terminal, too.
void open_browser(const std::string& url);

}  // namespace pingvox::app
