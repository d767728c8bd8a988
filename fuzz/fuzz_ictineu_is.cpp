#include "fuzz/bodies/beams.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pingvox::fuzz::beams({data, size});
  return 0;
}
