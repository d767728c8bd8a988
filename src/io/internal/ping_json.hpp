#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

namespace pingvox {

/// A ping of a Ping360, as the server of Ping Viewer 2 sends it to its clients (docs/formats.md).
struct PingJson {
  std::string device;               ///< by the server's number of it
  std::vector<std::uint8_t> frame;  ///< of the Ping protocol: device_data or auto_device_data
};

/// nullopt: another message of the server; the error is the reason why it is no ping.
tl::expected<std::optional<PingJson>, std::string> ping_in_json(std::string_view text);

}  // namespace pingvox
