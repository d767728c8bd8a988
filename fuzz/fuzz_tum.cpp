#include "fuzz/bodies/tum.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pingvox::fuzz::tum({data, size});
  return 0;
}
