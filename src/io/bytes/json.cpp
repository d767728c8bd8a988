#include "io/internal/json.hpp"

#include <fmt/core.h>

#include <cmath>

namespace pingvox {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";  // U+FFFD

/// Bytes of the well-formed UTF-8 character at the start of `text` (RFC 3629), 0 if invalid.
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(0);
  if (lead < 0x80) return 1;
  if (lead < 0xC2 || lead > 0xF4) return 0;
  const std::size_t length = lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
  if (text.size() < length) return 0;
  // The range of the second byte excludes overlong forms, surrogates, and code points above U+10FFFF.
  const unsigned char lowest = lead == 0xE0 ? 0xA0 : lead == 0xF0 ? 0x90 : 0x80;
  const unsigned char highest = lead == 0xED ? 0x9F : lead == 0xF4 ? 0x8F : 0xBF;
  if (byte(1) < lowest || byte(1) > highest) return 0;
  for (std::size_t i = 2; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
  }
  return length;
}

std::string quote(std::string_view text) {
  std::string out = "\"";
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const char c = text.front();
    if (length == 0) {
      out += kReplacement;
    } else if (length > 1) {
      out += text.substr(0, length);
    } else if (c == '"' || c == '\\') {
      out += {'\\', c};
    } else if (static_cast<unsigned char>(c) < 0x20) {
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    } else {
      out += c;
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return out + "\"";
}

std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "null";
}

}  // namespace

JsonObject& JsonObject::add_text(std::string_view key, std::string_view json) {
  if (!members_.empty()) members_ += ", ";
  members_ += quote(key);
  members_ += ": ";
  members_ += json;
  return *this;
}

JsonObject& JsonObject::add(std::string_view key, double value) {
  return add_text(key, number(value));
}
JsonObject& JsonObject::add(std::string_view key, std::uint64_t value) {
  return add_text(key, fmt::format("{}", value));
}
JsonObject& JsonObject::add(std::string_view key, int value) {
  return add_text(key, fmt::format("{}", value));
}
JsonObject& JsonObject::add(std::string_view key, std::string_view value) {
  return add_text(key, quote(value));
}
JsonObject& JsonObject::add(std::string_view key, const Eigen::Vector3d& value) {
  return add_text(key, fmt::format("[{}, {}, {}]", number(value.x()), number(value.y()), number(value.z())));
}
JsonObject& JsonObject::add(std::string_view key, const JsonObject& value) {
  return add_text(key, value.text());
}
JsonObject& JsonObject::add(std::string_view key, std::span<const JsonObject> values) {
  std::string json = "[";
  for (const JsonObject& value : values) json += (json.size() > 1 ? ",\n" : "\n") + value.text();
  return add_text(key, json + "\n]");
}
JsonObject& JsonObject::add(std::string_view key, std::span<const std::string> texts) {
  std::string json;
  for (const std::string& text : texts) json += (json.empty() ? "" : ", ") + quote(text);
  return add_text(key, "[" + json + "]");
}
JsonObject& JsonObject::add(std::string_view key, std::span<const double> values) {
  std::string json;
  for (const double value : values) json += (json.empty() ? "" : ", ") + number(value);
  return add_text(key, "[" + json + "]");
}
JsonObject& JsonObject::add_truth(std::string_view key, bool value) {
  return add_text(key, value ? "true" : "false");
}
JsonObject& JsonObject::add_null(std::string_view key) {
  return add_text(key, "null");
}

}  // namespace pingvox
