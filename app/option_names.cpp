#include "option_names.hpp"

#include <algorithm>
#include <array>
#include <cctype>

namespace pingvox::app {
namespace {

struct FieldOption {
  std::string_view field, option;
};
constexpr std::array kFieldOptions = {
    FieldOption{"background_m", "--background"}, FieldOption{"calibration:", "--use-calibration:"},
    FieldOption{"max_range_m", "--max-range"},   FieldOption{"max_z_m", "--max-z"},
    FieldOption{"min_range_m", "--min-range"},   FieldOption{"min_z_m", "--min-z"},
    FieldOption{"nav_offset_s", "--nav-offset"}, FieldOption{"nav_salinity", "--water nav,S"},
    FieldOption{"nav_sources", "--nav-source"},  FieldOption{"topic: has no effect", "--topic: has no effect"},
};

bool is_of_word(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.' || c == '/' || c == '-';
}

}  // namespace

std::string with_option_names(std::string_view message) {
  std::string text;
  while (!message.empty()) {
    const auto known = std::ranges::find_if(kFieldOptions, [&](const FieldOption& one) {
      const bool ends = message.size() <= one.field.size() || !is_of_word(message[one.field.size()]);
      return message.starts_with(one.field) && ends && (text.empty() || !is_of_word(text.back()));
    });
    if (known != kFieldOptions.end()) {
      text += known->option;
      message.remove_prefix(known->field.size());
    } else {
      text += message.front();
      message.remove_prefix(1);
    }
  }
  return text;
}

}  // namespace pingvox::app
