#include "dense_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/internal/ray_dda.hpp"
#include "pingvox/mapping/beam_model.hpp"

namespace pingvox::bench {

DenseGrid::DenseGrid(const Lattice& lattice, const Box& box) : lattice_(lattice) {
  // The middles of the outermost cells: a face of the box may be that of the next cell.
  const double half_m = 0.5 * lattice.resolution_m();
  const auto last = lattice.key_of(box.max.array() - half_m);
  first_ = *lattice.key_of(box.min.array() + half_m);
  width_ = std::size_t{last->x} - first_.x + 1;
  height_ = std::size_t{last->y} - first_.y + 1;
  beliefs_.assign(width_ * height_, std::numeric_limits<float>::quiet_NaN());
  votes_.assign(beliefs_.size(), 0.0F);
}

std::optional<std::size_t> DenseGrid::index_of(const Key& key) const {
  if (key.z != first_.z || key.x < first_.x || key.y < first_.y) return std::nullopt;
  const std::size_t column = std::size_t{key.x} - first_.x, row = std::size_t{key.y} - first_.y;
  if (column >= width_ || row >= height_) return std::nullopt;
  return row * width_ + column;
}

void DenseGrid::add(const PlacedSweep& sweep) {
  const BeamModelOptions model{.shape = BeamShape::kRay};
  const float miss = LogOdds::from_probability(0.4).value();
  std::vector<std::size_t> touched;
  const auto vote = [&](const Key& key, float evidence) {
    const auto cell = index_of(key);
    if (!cell) return;
    float& there = votes_[*cell];
    if (there == 0.0F) touched.push_back(*cell);
    there = there == 0.0F ? evidence : std::max(there, evidence);
  };
  for (const PlacedBeam& placed : sweep) {
    if (!placed.echo) continue;
    const Echo& echo = *placed.echo;
    const double free_m = std::min(echo.range_m, static_cast<double>(echo.first) * placed.beam.bin_length_m);
    if (const auto cells = dda<std::uint16_t>(lattice_, placed.map_from_sonar.translation(), placed.at(free_m))) {
      for (const Key& key : *cells) vote(key, miss);
    }
    if (const auto hit = lattice_.key_of(placed.at(echo.range_m))) {
      vote(*hit, evidence_of_intensity(echo.intensity, model.hit).value());
    }
  }
  const Clamp clamp;
  for (const std::size_t cell : touched) {
    const float before = std::isnan(beliefs_[cell]) ? 0.0F : beliefs_[cell];
    beliefs_[cell] = add_evidence(LogOdds(before), LogOdds(votes_[cell]), clamp).value();
    votes_[cell] = 0.0F;
  }
}

std::size_t DenseGrid::known() const {
  return static_cast<std::size_t>(std::ranges::count_if(beliefs_, [](float belief) { return !std::isnan(belief); }));
}

std::optional<LogOdds> DenseGrid::at(const Key& key) const {
  const auto cell = index_of(key);
  if (!cell || std::isnan(beliefs_[*cell])) return std::nullopt;
  return LogOdds(beliefs_[*cell]);
}

}  // namespace pingvox::bench
