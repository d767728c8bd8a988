#pragma once

#include <cstdint>

#include "map/kernels/lanes.hpp"

/// Loops over the words of bits that a page has for its bricks (ScanUpdate::Page), several words at a time.
namespace pingvox::detail {

/// for each of 64 words: its bit set where the word is not 0
std::uint64_t words_in_use(const std::uint64_t* words, Lanes lanes = widest_lanes());

/// for each of 64 words: to |= from, and from = 0
/// @return their bits as words_in_use(from) before
std::uint64_t move_words(std::uint64_t* from, std::uint64_t* to, Lanes lanes = widest_lanes());

/// Takes the cells of a page from a layer (ScanWindow::layer).
/// @param from  four words, which become 0
/// @param z     the bits of z in places of its cells
/// @param to    64 words of a page
/// @return the bits of those with such cells
std::uint64_t take_layer(std::uint64_t* from, std::uint64_t z, std::uint64_t* to, Lanes lanes = widest_lanes());

/// for each of 64 words: how many of its bits are set, all together
std::uint64_t count_cells(const std::uint64_t* words, Lanes lanes = widest_lanes());

}  // namespace pingvox::detail
