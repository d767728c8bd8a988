// A project that wants one layer only.
#include <pingvox/geometry/lattice.hpp>

int main() {
  const auto lattice = pingvox::Lattice::make(0.1);
  return lattice && lattice->key_of({0.0, 0.0, 0.0}) ? 0 : 1;
}
