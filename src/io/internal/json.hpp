#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace pingvox {

/// Builds a JSON object (RFC 8259). Keys keep their order; invalid UTF-8 is replaced, non-finite numbers become null;
/// independent of the locale.
class JsonObject {
 public:
  JsonObject& add(std::string_view key, double value);
  JsonObject& add(std::string_view key, std::uint64_t value);
  JsonObject& add(std::string_view key, int value);
  JsonObject& add(std::string_view key, std::string_view value);
  JsonObject& add(std::string_view key, const char* value) { return add(key, std::string_view(value)); }
  JsonObject& add(std::string_view key, const Eigen::Vector3d& value);  ///< [x, y, z]
  JsonObject& add(std::string_view key, const JsonObject& value);
  JsonObject& add(std::string_view key, std::span<const JsonObject> values);  ///< an array, each on its own line
  JsonObject& add(std::string_view key, std::span<const std::string> texts);  ///< an array
  JsonObject& add(std::string_view key, std::span<const double> values);      ///< the same
  JsonObject& add_truth(std::string_view key, bool value);                    ///< true or false
  JsonObject& add_null(std::string_view key);

  /// The object on one line, without a final line break.
  std::string text() const { return "{" + members_ + "}"; }

 private:
  JsonObject& add_text(std::string_view key, std::string_view json);
  std::string members_;
};

}  // namespace pingvox
