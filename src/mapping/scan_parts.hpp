#pragma once

#include <algorithm>
#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

#include "pingvox/map/scan_update.hpp"

namespace pingvox::detail {

/// Threads that each trace a part of a scan into a scan update of their own, which then go into one. The result does
/// not depend on their number: a cell is marked or not, and of several hits the one with most evidence counts.
class ScanParts {
 public:
  /// Minimum number of rays or beams that is worth a thread.
  static constexpr std::size_t kMinPerThread = 16;

  explicit ScanParts(std::size_t threads) : threads_(threads) {}

  /// Calls trace(part, first, last, scan) for each part of 0..count, parts numbered from 0 on; the calling thread takes
  /// the first part, and those whose thread does not start. Throws what `trace` throws: the scan then holds some marks.
  template <class Trace>
  void run(std::size_t count, ScanUpdate& scan, const Trace& trace) {
    const std::size_t parts = std::clamp<std::size_t>(count / kMinPerThread, 1, threads_);
    while (others_.size() + 1 < parts) others_.emplace_back(scan.lattice(), scan.miss());
    for (ScanUpdate& other : others_) other.clear();
    const auto begin_of = [&](std::size_t part) { return count * part / parts; };
    std::vector<std::exception_ptr> thrown(parts);
    {
      std::vector<std::jthread> threads;
      threads.reserve(parts);
      const auto trace_part = [&](std::size_t part) {
        try {
          trace(part, begin_of(part), begin_of(part + 1), others_[part - 1]);
        } catch (const std::exception&) {
          thrown[part] = std::current_exception();
        }
      };
      std::size_t started = 1;
      try {
        for (; started < parts; ++started) threads.emplace_back(trace_part, started);
        // No thread is left, or no memory for one: the caller traces those parts below.
      } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch)
      }
      trace(std::size_t{0}, begin_of(0), begin_of(1), scan);
      for (std::size_t part = started; part < parts; ++part) trace_part(part);
    }
    for (const std::exception_ptr& one : thrown) {
      if (one) std::rethrow_exception(one);
    }
    for (std::size_t part = 1; part < parts; ++part) scan.add(others_[part - 1]);
  }

 private:
  std::size_t threads_;
  std::vector<ScanUpdate> others_;
};

}  // namespace pingvox::detail
