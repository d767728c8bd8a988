#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "pingvox/mapping/build_options.hpp"
#include "pingvox/sonar/beam.hpp"
#include "pingvox/web/scene.hpp"
#include "pingvox/web/scene_bytes.hpp"
#include "sonar/internal/echo_stream.hpp"

namespace pingvox::web {

/// The last beams of a head, with their echoes as the mapper finds them.
class LiveLog {
 public:
  static constexpr std::size_t kMaxBeams = 4096;

  /// @param build       as for the map
  /// @param of_first_s  time of the page at time 0 of the beams
  LiveLog(const BuildOptions& build, double of_first_s);

  void add(Beam beam);

  /// Without beams: name, size of the beam, mount and number of bins.
  SceneLog description(std::size_t beams) const;
  std::size_t first() const { return first_; }                ///< number of the first beam that is kept
  std::size_t end() const { return first_ + beams_.size(); }  ///< of the one after the last
  /// Of the first one whose echo is not final.
  std::size_t settled() const { return settled_; }
  std::size_t bins() const { return bins_; }

  /// As `log/N` of the beams that are kept, from a number on.
  Bytes beams_from(std::size_t number) const;
  /// As `log/N/bins`. nullopt: some of them are not kept.
  std::optional<Bytes> bins_of(std::size_t from, std::size_t to) const;

 private:
  struct Kept {
    SceneBeam beam;
    std::vector<std::uint8_t> bins;
    bool is_settled = false;
  };
  void settle(const EchoStream::BeamWithEcho& heard);

  BuildOptions build_;
  double of_first_s_;
  EchoStream stream_;
  std::deque<Kept> beams_;
  std::size_t first_ = 0, settled_ = 0;
  std::size_t bins_ = 1;  ///< of the longest beam so far
};

}  // namespace pingvox::web
