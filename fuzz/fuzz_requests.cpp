#include "fuzz/bodies/requests.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pingvox::fuzz::requests({data, size});
  return 0;
}
