#include "fuzz/bodies/nav.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pingvox::fuzz::nav({data, size});
  return 0;
}
