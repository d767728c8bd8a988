#pragma once

#include <string>
#include <string_view>

namespace pingvox::app {

/// A message of the library, which names the fields of options, with the names of the command line's options instead:
/// "give nav_offset_s, the seconds to add" becomes "give --nav-offset, the seconds to add".
std::string with_option_names(std::string_view message);

}  // namespace pingvox::app
