#include "live/recordings.hpp"

#include <system_error>

namespace pingvox {

Recordings::~Recordings() {
  std::error_code ignored;
  for (const std::filesystem::path& path : created_) std::filesystem::remove(path, ignored);
}

}  // namespace pingvox
