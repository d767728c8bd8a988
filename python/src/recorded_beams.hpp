#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pingvox/sonar/beam.hpp"

namespace pingvox::python {

/// Beams in order of recording, which do not change. Their views share them.
struct RecordedBeams {
  std::shared_ptr<const std::vector<Beam>> beams;
  std::string note;
  std::size_t skipped = 0;

  explicit RecordedBeams(std::vector<Beam> all) : beams(std::make_shared<const std::vector<Beam>>(std::move(all))) {}
};

}  // namespace pingvox::python
