#include "fuzz/bodies/scans.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pingvox::fuzz::scans({data, size});
  return 0;
}
