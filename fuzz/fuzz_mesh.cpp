#include "fuzz/bodies/mesh.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pingvox::fuzz::mesh({data, size});
  return 0;
}
