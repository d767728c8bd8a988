#include "mapping/kernels/ray_ends.hpp"

// Highway compiles what follows up to HWY_AFTER_NAMESPACE once for each kind of machine.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mapping/kernels/ray_ends.cpp"
#include <hwy/foreach_target.h>
// It must come after it.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pingvox::detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void find_ends_here(const RayEnds& ends, double way_x, double way_y, std::span<const double> across, const double* up,
                    std::uint64_t* places) {
  const hn::ScalableTag<double> doubles;
  const hn::RebindToSigned<decltype(doubles)> ints;
  const hn::RebindToUnsigned<decltype(doubles)> words;
  using DoubleVec = hn::Vec<decltype(doubles)>;
  using UintVec = hn::Vec<decltype(words)>;
  const DoubleVec range_m = hn::Set(doubles, ends.range_m);
  for (std::size_t first = 0; first < across.size(); first += hn::Lanes(doubles)) {
    const DoubleVec level = hn::LoadU(doubles, across.data() + first), height = hn::LoadU(doubles, up + first);
    const DoubleVec x = level * hn::Set(doubles, way_x) * range_m, y = level * hn::Set(doubles, way_y) * range_m,
                    z = height * range_m;
    UintVec place = hn::Zero(words);
    auto inside = hn::FirstN(doubles, hn::Lanes(doubles));
    for (std::size_t a = 0; a < 3; ++a) {
      const std::array<double, 4>& row = ends.map_from_sensor[a];
      const DoubleVec end_m = hn::Set(doubles, row[0]) * x + hn::Set(doubles, row[1]) * y +
                              hn::Set(doubles, row[2]) * z + hn::Set(doubles, row[3]);
      const DoubleVec cell = end_m * hn::Set(doubles, ends.cells_per_m);
      inside = hn::And(inside, hn::And(hn::Ge(cell, hn::Set(doubles, ends.inside_from[a])),
                                       hn::Lt(cell, hn::Set(doubles, ends.inside_to[a]))));
      const DoubleVec counted = hn::Floor(cell) - hn::Set(doubles, static_cast<double>(ends.lowest[a]));
      const UintVec number = hn::And(hn::BitCast(words, hn::ConvertTo(ints, counted)), hn::Set(words, (1 << 21) - 1));
      UintVec in_page = hn::And(number, hn::Set(words, 15));
      in_page = hn::And(hn::Or(in_page, hn::ShiftLeft<4>(in_page)), hn::Set(words, 0xC3));
      in_page = hn::And(hn::Or(in_page, hn::ShiftLeft<2>(in_page)), hn::Set(words, 0x249));
      place = hn::Or(place, hn::ShiftLeftSame(in_page, static_cast<int>(a)));
      place = hn::Or(place, hn::ShiftLeftSame(hn::ShiftRight<4>(number), kCellBits + static_cast<int>(a) * kPlaceBits));
    }
    const auto has_place = hn::RebindMask(words, inside);
    hn::StoreU(hn::IfThenElse(has_place, place, hn::Set(words, kNoPlace)), words, places + first);
  }
}

}  // namespace pingvox::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pingvox::detail {
namespace {
HWY_EXPORT(find_ends_here);
}  // namespace

void find_ends(const RayEnds& ends, double way_x, double way_y, std::span<const double> across, const double* up,
               std::uint64_t* places) {
  HWY_DYNAMIC_DISPATCH(find_ends_here)(ends, way_x, way_y, across, up, places);
}

}  // namespace pingvox::detail
#endif
