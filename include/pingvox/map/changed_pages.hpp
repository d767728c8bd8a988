#pragma once

#include <cstddef>
#include <unordered_set>
#include <utility>
#include <vector>

#include "pingvox/geometry/key.hpp"

namespace pingvox {

class ScanUpdate;

/// The parts of a map that scans have updated since they were taken last, for observers of a growing map. It
/// is not larger than the map.
class ChangedPages {
 public:
  struct Taken {
    bool all = false;             ///< the whole map may have changed
    std::vector<WideKey> lowest;  ///< else the lowest cells of pages (ScanUpdate::Page), each once, in no order
  };

  void add(const ScanUpdate& scan);
  /// The whole map has changed.
  void add_all();
  bool empty() const { return !all_ && lowest_.empty(); }
  Taken take();

 private:
  struct Hash {
    std::size_t operator()(const WideKey& key) const;
  };

  bool all_ = false;
  std::unordered_set<WideKey, Hash> lowest_;
};

}  // namespace pingvox
