#include "map/kernels/words.hpp"

#include <cstddef>
#include <cstring>
#include <utility>

namespace pingvox::detail {
namespace {

#define PINGVOX_LOOPS "map/kernels/words_loops.hpp"
#include "map/kernels/each_machine.hpp"

}  // namespace

std::uint64_t words_in_use(const std::uint64_t* words, Lanes lanes) {
  PINGVOX_BY_LANES(lanes, words_in_use(words), plain::words_in_use(words));
}

std::uint64_t move_words(std::uint64_t* from, std::uint64_t* to, Lanes lanes) {
  PINGVOX_BY_LANES(lanes, move_words(from, to), plain::move_words(from, to));
}

std::uint64_t take_layer(std::uint64_t* from, std::uint64_t z, std::uint64_t* to, Lanes lanes) {
  PINGVOX_BY_LANES(lanes, take_layer(from, z, to), plain::take_layer(from, z, to));
}

std::uint64_t count_cells(const std::uint64_t* words, Lanes lanes) {
  PINGVOX_BY_LANES(lanes, count_cells(words), plain::count_cells(words));
}

}  // namespace pingvox::detail
