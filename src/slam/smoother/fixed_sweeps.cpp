#include "slam/smoother/fixed_sweeps.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

namespace pingvox {
namespace {

constexpr std::size_t kOfSquare = 24;

/// nullopt: farther away than any vehicle goes.
std::optional<std::pair<int, int>> square_of(const Eigen::Vector2d& place_m) {
  const Eigen::Vector2d square = (place_m / kFarReach_m).array().floor();
  if (!(square.array().abs() < 1e9).all()) return std::nullopt;  // NaN is not, either
  return std::pair{static_cast<int>(square.x()), static_cast<int>(square.y())};
}

}  // namespace

void FixedSweeps::add(FixedSweep sweep) {
  assert(last_.empty() || sweep.place.number > last_.back()->place.number);
  last_.push_back(std::make_shared<const FixedSweep>(std::move(sweep)));
  if (last_.size() > kFarthestNear) last_.pop_front();
  const auto square = square_of(last_.back()->place.place_m);
  if (!square) return;
  std::vector<std::shared_ptr<const FixedSweep>>& there = squares_[*square];
  if (there.size() < kOfSquare) there.push_back(last_.back());
}

std::vector<std::shared_ptr<const FixedSweep>> FixedSweeps::partners(std::span<const SweepPlace> window,
                                                                     double reach_m) const {
  std::map<std::size_t, std::shared_ptr<const FixedSweep>> chosen;
  for (const auto& sweep : last_) chosen.emplace(sweep->place.number, sweep);
  std::vector<std::pair<std::uint64_t, std::shared_ptr<const FixedSweep>>> far;
  for (const SweepPlace& sweep : window) {
    const auto square = square_of(sweep.place_m);
    if (!square) continue;
    far.clear();
    for (int x = square->first - 1; x <= square->first + 1; ++x) {
      for (int y = square->second - 1; y <= square->second + 1; ++y) {
        const auto there = squares_.find({x, y});
        if (there == squares_.end()) continue;
        for (const auto& other : there->second) {
          if (sweep.number - other->place.number <= kFar) continue;
          if ((other->place.place_m - sweep.place_m).norm() > reach_m) continue;
          far.emplace_back(partner_rank(seed_, sweep.number, other->place.number), other);
        }
      }
    }
    const auto count = static_cast<std::ptrdiff_t>(std::min(far.size(), kFarPartners));
    std::ranges::partial_sort(far, far.begin() + count, {}, [](const auto& ranked) { return ranked.first; });
    for (auto at = far.begin(); at != far.begin() + count; ++at) chosen.emplace(at->second->place.number, at->second);
  }
  std::vector<std::shared_ptr<const FixedSweep>> partners;
  for (auto& [number, sweep] : chosen) partners.push_back(std::move(sweep));
  return partners;
}

std::vector<std::shared_ptr<const FixedSweep>> FixedSweeps::near(const Eigen::Vector2d& place_m, double reach_m) const {
  std::vector<std::shared_ptr<const FixedSweep>> sweeps;
  const Eigen::Vector2d reach = Eigen::Vector2d::Constant(reach_m);
  const auto low = square_of(place_m - reach), high = square_of(place_m + reach);
  if (!low || !high) return sweeps;
  for (int x = low->first; x <= high->first; ++x) {
    for (auto at = squares_.lower_bound({x, low->second});
         at != squares_.end() && at->first <= std::pair(x, high->second); ++at) {
      for (const auto& sweep : at->second) {
        if ((sweep->place.place_m - place_m).norm() <= reach_m) sweeps.push_back(sweep);
      }
    }
  }
  std::ranges::sort(sweeps, {}, [](const auto& sweep) { return sweep->place.number; });
  return sweeps;
}

}  // namespace pingvox
