#pragma once

#include <algorithm>
#include <cstddef>
#include <exception>
#include <new>
#include <thread>
#include <vector>

#include "pingvox/map/scan_update.hpp"

namespace pingvox {

/// Threads that each trace a part of a scan into a scan update of their own, which then go into one. The result does
/// not depend on how many there are: a cell is marked or not, and of several hits the surest counts.
class ScanParts {
 public:
  /// Fewer rays or beams than this for each thread are not worth starting it.
  static constexpr std::size_t kLeast = 16;

  explicit ScanParts(std::size_t threads) : threads_(threads) {}

  /// Calls trace(part, first, last, scan) for each part of 0..count, parts numbered from 0 on; the calling thread takes
  /// the first part. Throws what a part threw.
  template <class Trace>
  void run(std::size_t count, ScanUpdate& scan, Trace&& trace) {
    const std::size_t parts = std::clamp<std::size_t>(count / kLeast, 1, threads_);
    while (others_.size() + 1 < parts) others_.emplace_back(scan.miss());
    const auto begin_of = [&](std::size_t part) { return count * part / parts; };
    std::vector<std::exception_ptr> failed(parts);
    {
      std::vector<std::jthread> threads;
      for (std::size_t part = 1; part < parts; ++part) {
        threads.emplace_back([&, part] {
          try {
            trace(part, begin_of(part), begin_of(part + 1), others_[part - 1]);
          } catch (...) {
            failed[part] = std::current_exception();
          }
        });
      }
      trace(std::size_t{0}, begin_of(0), begin_of(1), scan);
    }
    for (std::size_t part = 1; part < parts; ++part) {
      scan.add(others_[part - 1]);
      others_[part - 1].clear();
    }
    for (const std::exception_ptr& exception : failed) {
      if (exception) std::rethrow_exception(exception);
    }
  }

 private:
  std::size_t threads_;
  std::vector<ScanUpdate> others_;
};

}  // namespace pingvox
