#include <utility>

#include "io/cloud.hpp"
#include "io/readers.hpp"
#include "io/text.hpp"

// Points as text: `x y z` and optional further columns, one point a line (docs/formats.md).
namespace pingvox {

bool looks_like_xyz(std::span<const std::uint8_t> bytes) {
  // Longer lines are beams without a header.
  constexpr std::size_t kMaxWords = 16;
  constexpr int kLines = 10;
  Lines lines(text_of(bytes));
  for (int looked_at = 0; looked_at < kLines; ++looked_at) {
    auto line = lines.next_with_content();
    if (!line) return looked_at > 0;
    std::size_t count = 0;
    while (const auto word = cut_word(*line)) {
      if (++count > kMaxWords || (looked_at == 0 && !number_in(*word))) return false;
    }
    if (looked_at == 0 && count < 3) return false;
  }
  return true;
}

Result<std::unique_ptr<ScanSource>> open_xyz(FileBytes file, Damage damage, const CloudOrigin& origin_m) {
  TextCloud cloud;
  for (std::size_t axis = 0; axis < 3; ++axis) cloud.xyz[axis].word = axis;
  const Lines lines(text_of(file.view()));
  return text_cloud(std::move(file), lines, cloud, damage, origin_m.value_or(Eigen::Vector3d::Zero()));
}

}  // namespace pingvox
