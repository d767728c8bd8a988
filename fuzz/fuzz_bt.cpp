#include "fuzz/bodies/maps.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pingvox::fuzz::maps({data, size});
  return 0;
}
