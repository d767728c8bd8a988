#include "web/blueos.hpp"

#include <array>
#include <memory>
#include <string_view>

#include "web/hosts.hpp"

namespace pingvox::web {
namespace {

std::string_view blueos_service() {
  // All of the first seven are needed, be they empty. The menu of BlueOS shows the page behind its proxy, so the links
  // of the page have to be relative.
  return R"({
  "name": "pingvox",
  "description": "3D maps of a scanning sonar, while the vehicle moves",
  "icon": "mdi-radar",
  "company": "pingvox",
  "version": ")" PINGVOX_VERSION R"(",
  "webpage": "",
  "api": "",
  "works_in_relative_paths": true,
  "extras": { "cockpit": "/cockpit_extras.json" }
}
)";
}

std::string_view cockpit_extras() {
  // A widget without an icon makes Cockpit drop the whole file.
  return R"({
  "targetSystem": "Cockpit",
  "targetCockpitApiVersion": "1.0.0",
  "widgets": [
    {
      "name": "pingvox",
      "version": ")" PINGVOX_VERSION R"(",
      "iframeUrl": "/",
      "iframeIcon": "/icon.svg",
      "useExtensionPathAsBaseUrl": true
    }
  ]
}
)";
}

std::string_view cockpit_icon() {
  return R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 24 24" fill="none" stroke="#fff" stroke-width="1.6">
<circle cx="12" cy="12" r="10"/><circle cx="12" cy="12" r="5.5"/><path d="M12 12 18.5 4.5"/>
</svg>
)";
}

struct Document {
  std::string_view target, type, text;
};

}  // namespace

std::optional<Answer> blueos_answer(const Request& request, const Access& access) {
  constexpr std::string_view kJsonText = "application/json; charset=utf-8";
  const std::array documents = {Document{"/register_service", kJsonText, blueos_service()},
                                Document{"/cockpit_extras.json", kJsonText, cockpit_extras()},
                                Document{"/icon.svg", "image/svg+xml", cockpit_icon()}};
  const bool is_answered = access.readers == Readers::kLocalNetwork && request.method == "GET" && request.host &&
                           is_own_host(*request.host, access);
  if (!is_answered) return std::nullopt;
  for (const Document& document : documents) {
    if (request.target != document.target) continue;
    Answer answer;
    answer.type = document.type;
    answer.owned = std::make_shared<const Bytes>(document.text.begin(), document.text.end());
    answer.body = *answer.owned;
    // The proxy of the vehicle, which does not name our port, adds this header itself; twice it counts as none.
    static constexpr std::array kForAll = {Header{"Access-Control-Allow-Origin", "*"}};
    if (port_of_host(*request.host) == access.port) answer.headers = kForAll;
    return answer;
  }
  return std::nullopt;
}

}  // namespace pingvox::web
