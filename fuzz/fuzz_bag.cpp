#include "fuzz/bodies/bag.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pingvox::fuzz::bag({data, size});
  return 0;
}
