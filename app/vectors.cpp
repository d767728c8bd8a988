#include "vectors.hpp"

#include <fmt/core.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstdlib>

namespace pingvox::app {
namespace {

std::string name_of(std::int64_t target) {
  std::string name = hwy::TargetName(target);
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  return name;
}

}  // namespace

Result<void> limit_vectors() {
  const char* const wanted = std::getenv("PINGVOX_VECTORS");
  if (wanted == nullptr || *wanted == '\0') return {};
  std::string names;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    if (name_of(target) == wanted) {
      hwy::DisableTargets(target - 1);  // wider ones have lower bits
      return {};
    }
    names += (names.empty() ? "" : ", ") + name_of(target);
  }
  return fail(Error::Code::kBadOption, fmt::format("PINGVOX_VECTORS: must be one of {}, is '{}'", names, wanted));
}

std::string vectors_in_use() {
  return name_of(hwy::SupportedAndGeneratedTargets().front());
}

}  // namespace pingvox::app
