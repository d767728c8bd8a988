#pragma once

#include <string>

namespace pingvox {

/// Two frames of tf, for the pose of `child` in `parent`.
struct TfFrames {
  std::string parent, child;
};

}  // namespace pingvox
