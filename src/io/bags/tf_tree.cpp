#include "io/bags/tf_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <set>
#include <tuple>

#include "nav/internal/nav_frames.hpp"

namespace pingvox {
namespace {

/// A vehicle with arms has some hundred frames. Chains are walked for each of the first few frames that move.
constexpr std::size_t kMaxFrames = 1024, kMaxChain = 32, kMaxPaths = 16;

bool never_moves(const std::vector<StampedPose>& poses) {
  return std::ranges::all_of(poses, [&](const StampedPose& pose) {
    return pose.map_from_body.matrix() == poses.front().map_from_body.matrix();
  });
}

/// Their times alone: where they have gaps, and whether the clock was set back.
NavSource times_of(const std::vector<StampedPose>& poses) {
  NavSource times;
  for (const StampedPose& pose : poses) times.samples.push_back({.time_s = pose.time_s});
  const auto log = NavLog::make({std::move(times)}, NavClock::kUnix);
  return log && !log->sources().empty() ? log->sources().front() : NavSource{};
}

/// One transform of a chain at all times.
struct Step {
  Trajectory trajectory;
  std::optional<ClockStep> step_back = std::nullopt;
};

std::optional<Step> step_of(const std::vector<StampedPose>& poses) {
  const NavSource times = times_of(poses);
  if (times.samples.empty()) return std::nullopt;
  std::vector<std::size_t> order(poses.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::sort(order, {}, [&](std::size_t i) { return std::pair(poses[i].time_s, i); });
  std::vector<StampedPose> sorted;
  for (const std::size_t i : order) {
    if (sorted.empty() || poses[i].time_s > sorted.back().time_s) sorted.push_back(poses[i]);
  }
  Result<Trajectory> trajectory = Trajectory::make(std::move(sorted), summary_of(times).longest_step_s);
  if (!trajectory) return std::nullopt;
  return Step{*std::move(trajectory), times.step_back};
}

/// All transforms of a chain together; nullopt where one of them is not known.
std::optional<Pose> pose_at(const std::vector<Step>& steps, double time_s) {
  Pose pose = Pose::Identity();
  for (const Step& step : steps) {
    const std::optional<Pose> next = step.trajectory.at(time_s);
    if (!next) return std::nullopt;
    pose = pose * *next;
  }
  return pose;
}

}  // namespace

std::optional<std::size_t> TfTree::frame_of(std::string_view name) {
  const auto known = places_.find(name);
  if (known != places_.end()) return known->second;
  if (names_.size() >= kMaxFrames) return std::nullopt;
  names_.emplace_back(name);
  places_.emplace(names_.back(), names_.size() - 1);
  return names_.size() - 1;
}

void TfTree::add(std::string_view parent, std::string_view child, double time_s, const Pose& parent_from_child,
                 Link link) {
  const auto above = frame_of(parent), below = frame_of(child);
  if (!above || !below || above == below || !std::isfinite(time_s) || !parent_from_child.matrix().allFinite()) {
    ++left_out_;
    return;
  }
  if (links_.size() >= kMaxFrames && !links_of_.contains({*above, *below})) {
    ++left_out_;
    return;
  }
  const auto [place, is_new] = links_of_.try_emplace({*above, *below}, links_.size());
  if (is_new) links_.push_back({*above, *below, link, {}});
  Transforms& transforms = links_[place->second];
  if (link == Link::kStatic) {
    // The last one counts, but not instead of what moves.
    if (transforms.link == Link::kStatic) transforms.poses.assign(1, {time_s, parent_from_child});
    return;
  }
  if (transforms.link == Link::kStatic) transforms.poses.clear();
  transforms.link = Link::kMoving;
  transforms.poses.push_back({time_s, parent_from_child});
}

/// Of each frame the transform to its parent, the one that came most often; nullptr: it has none.
std::vector<const TfTree::Transforms*> TfTree::main_parents() const {
  std::vector<const Transforms*> parents(names_.size(), nullptr);
  for (const Transforms& link : links_) {
    const Transforms*& main = parents[link.child];
    const auto key = [&](const Transforms& of) { return std::pair(of.poses.size(), names_[of.parent]); };
    if (main == nullptr || key(link) > key(*main)) main = &link;
  }
  return parents;
}

/// From a transform out of a fixed frame down to `base_link`, the nearest of that name; without one, this one alone.
TfTree::Chain TfTree::chain_to_vehicle(const Transforms& top, Parents parents) const {
  const auto chain_up_from = [&](std::size_t frame) -> std::optional<Chain> {
    Chain chain;
    while (frame != top.child) {
      const Transforms* const link = parents[frame];
      if (link == nullptr || chain.size() >= kMaxChain) return std::nullopt;
      chain.insert(chain.begin(), link);
      frame = link->parent;
    }
    chain.insert(chain.begin(), &top);
    return chain;
  };
  std::optional<Chain> nearest;
  for (std::size_t frame = 0; frame < names_.size(); ++frame) {
    if (!is_base_link(names_[frame])) continue;
    std::optional<Chain> chain = chain_up_from(frame);
    if (chain && (!nearest || chain->size() < nearest->size())) nearest = std::move(chain);
  }
  return nearest.value_or(Chain{&top});
}

/// "map -> odom -> base_link"
std::string TfTree::text_of(const Chain& chain) const {
  std::string text = names_[chain.front()->parent];
  for (const Transforms* link : chain) text += " -> " + names_[link->child];
  return text;
}

/// "/tf:map:base_link"
std::string TfTree::source_of(const std::string& topic, const Chain& chain) const {
  return fmt::format("{}:{}:{}", topic, names_[chain.front()->parent], names_[chain.back()->child]);
}

/// @param source  with the name and the subject
/// @return false: the transforms are never known together at later times than `after_s`
bool TfTree::add_path(const Chain& chain, const NavSource& source, Known known, double after_s,
                      std::vector<NavSource>& sources) const {
  const auto is_still = [&](const Transforms* link) {
    return link->link == Link::kStatic || (known == Known::kOfLog && never_moves(link->poses));
  };
  // Of a vehicle that stands still all times count.
  const bool moves = !std::ranges::all_of(chain, is_still);
  std::vector<Step> steps;
  std::vector<double> times_s;
  std::optional<ClockStep> step_back;
  for (const Transforms* link : chain) {
    if (link->link == Link::kMoving && (!is_still(link) || !moves)) {
      for (const StampedPose& pose : link->poses) times_s.push_back(pose.time_s);
    }
    if (is_still(link)) {
      steps.push_back({Trajectory::still(link->poses.front().map_from_body)});
      continue;
    }
    std::optional<Step> step = step_of(link->poses);
    if (!step) return false;
    if (step->step_back) step_back = step->step_back;
    steps.push_back(*std::move(step));
  }
  std::erase_if(times_s, [&](double time_s) { return !(time_s > after_s); });
  std::ranges::sort(times_s);
  times_s.erase(std::ranges::unique(times_s).begin(), times_s.end());
  NavSource position = source;
  position.quantity = NavQuantity::kPosition;
  position.step_back = step_back;
  position.frame = names_[chain.front()->parent];
  position.child = names_[chain.back()->child];
  if (chain.size() > 1) position.note = text_of(chain);
  NavSource attitude = position;
  attitude.quantity = NavQuantity::kAttitude;
  for (const double time_s : times_s) {
    const std::optional<Pose> pose = pose_at(steps, time_s);
    if (!pose) continue;
    position.samples.push_back({.time_s = time_s, .value = pose->translation()});
    attitude.samples.push_back({.time_s = time_s, .value = rpy_of(pose->rotation())});
  }
  if (position.samples.empty()) return false;
  sources.push_back(std::move(position));
  sources.push_back(std::move(attitude));
  return true;
}

bool TfTree::ends_at_vehicle(const Chain& chain) const {
  return is_vehicle_frame(names_[chain.back()->child]);
}

/// From each transform out of a fixed frame: those to vehicles first, then those that came most often.
std::vector<TfTree::Chain> TfTree::chains_to_vehicles(Parents parents) const {
  Chain tops;
  for (const Transforms& link : links_) {
    if (is_fixed_frame(names_[link.parent]) && !is_fixed_frame(names_[link.child])) tops.push_back(&link);
  }
  std::vector<Chain> chains;
  for (const Transforms* top : tops) chains.push_back(chain_to_vehicle(*top, parents));
  std::ranges::sort(chains, {}, [&](const Chain& chain) {
    return std::tuple(!ends_at_vehicle(chain), -static_cast<std::int64_t>(chain.front()->poses.size()), text_of(chain));
  });
  return chains;
}

/// From the fixed frame at the root to the one next to the vehicle.
std::vector<TfTree::Chain> TfTree::with_frames_above(Chain chain, Parents parents) const {
  std::vector<Chain> longer = {chain};
  while (chain.size() < kMaxChain) {
    const Transforms* const above = parents[chain.front()->parent];
    if (above == nullptr || !is_fixed_frame(names_[above->parent])) break;
    if (std::ranges::any_of(chain, [&](const Transforms* link) { return link->parent == above->parent; })) break;
    chain.insert(chain.begin(), above);
    longer.push_back(chain);
  }
  std::ranges::reverse(longer);
  return longer;
}

std::vector<NavSource> TfTree::paths(const std::string& topic) const {
  const std::vector<const Transforms*> parents = main_parents();
  std::vector<NavSource> sources;
  for (const Chain& chain : chains_to_vehicles(parents)) {
    NavSource source;
    source.subject = ends_at_vehicle(chain) ? NavSubject::kTransforms : NavSubject::kUncertain;
    for (const Chain& path : with_frames_above(chain, parents)) {
      if (sources.size() >= 2 * kMaxPaths) break;
      source.name = source_of(topic, path);
      if (std::ranges::find(sources, source.name, &NavSource::name) != sources.end()) continue;
      constexpr double kBegin_s = -std::numeric_limits<double>::infinity();
      if (add_path(path, source, Known::kOfLog, kBegin_s, sources)) source.subject = NavSubject::kUncertain;
    }
  }
  return sources;
}

Result<TfFrames> TfTree::vehicle_frames() const {
  const std::vector<const Transforms*> parents = main_parents();
  std::set<std::string> vehicles, others;  // "map:base_link"
  std::optional<TfFrames> found;
  for (const Chain& chain : chains_to_vehicles(parents)) {
    constexpr std::size_t kMaxNamed = 8;
    std::set<std::string>& names = ends_at_vehicle(chain) ? vehicles : others;
    if (names.size() >= kMaxNamed) continue;
    const Chain from_root = with_frames_above(chain, parents).front();
    const TfFrames frames{names_[from_root.front()->parent], names_[from_root.back()->child]};
    names.insert(frames.parent + ":" + frames.child);
    if (!found) found = frames;
  }
  if (vehicles.size() == 1) return *found;
  std::string reason = unjoined_text();
  if (vehicles.size() > 1) {
    reason =
        fmt::format("tf has several vehicles, or one in several frames: name one of {}", fmt::join(vehicles, ", "));
  } else if (reason.empty()) {
    reason = "tf has no vehicle (base_link) in a fixed frame (map, odom, world)";
    if (!others.empty()) reason += fmt::format(": if it is one of {}, name it", fmt::join(others, ", "));
  }
  return fail(Error::Code::kUnsupported, std::move(reason));
}

/// Up from the child; where a frame has several parents, the wanted one is preferred.
Result<TfTree::Chain> TfTree::chain_between(const TfFrames& frames, double now_s) const {
  constexpr double kLongest_s = 5.0;
  const auto parent = places_.find(frames.parent), child = places_.find(frames.child);
  const std::vector<const Transforms*> parents = main_parents();
  Chain chain;
  while (parent != places_.end() && child != places_.end() && chain.size() < kMaxChain) {
    const std::size_t at = chain.empty() ? child->second : chain.front()->parent;
    if (at == parent->second) break;
    const auto wanted = links_of_.find({parent->second, at});
    const Transforms* const link = wanted == links_of_.end() ? parents[at] : &links_[wanted->second];
    if (link == nullptr) break;
    chain.insert(chain.begin(), link);
  }
  if (chain.empty() || chain.front()->parent != parent->second) {
    return fail(Error::Code::kUnsupported, fmt::format("tf does not join {} to {}", frames.child, frames.parent));
  }
  const auto is_static = [](const Transforms* link) { return link->link == Link::kStatic; };
  if (std::ranges::all_of(chain, is_static)) {
    return fail(Error::Code::kUnsupported,
                fmt::format("all transforms of tf from {} to {} are static", frames.parent, frames.child));
  }
  for (const Transforms* link : chain) {
    if (is_static(link) || now_s - link->poses.back().time_s <= kLongest_s) continue;
    return fail(Error::Code::kUnsupported, fmt::format("tf has had no {} in {} for {:.0f} s", names_[link->child],
                                                       names_[link->parent], kLongest_s));
  }
  return chain;
}

Result<std::vector<NavSource>> TfTree::path(const std::string& topic, const TfFrames& frames, double after_s,
                                            double now_s) const {
  return chain_between(frames, now_s).map([&](const Chain& chain) {
    NavSource source;
    source.name = source_of(topic, chain);
    source.subject = NavSubject::kTransforms;
    std::vector<NavSource> sources;
    add_path(chain, source, Known::kSoFar, after_s, sources);
    return sources;
  });
}

void TfTree::forget_before(double time_s) {
  for (Transforms& transforms : links_) {
    if (transforms.link == Link::kStatic) continue;
    std::vector<StampedPose>& poses = transforms.poses;
    const StampedPose last = poses.back();
    std::erase_if(poses, [&](const StampedPose& pose) { return pose.time_s < time_s; });
    if (poses.empty()) poses.push_back(last);
  }
}

std::optional<TfTree::Mount> TfTree::mount_of(std::string_view frame) const {
  const auto place = places_.find(frame);
  if (place == places_.end()) return std::nullopt;
  const std::vector<const Transforms*> parents = main_parents();
  const auto is_down = [](std::string_view name) { return axes_of(name) == FrameAxes::kDown; };
  const Pose ours_from_frd = pose_from_rpy(Eigen::Vector3d::Zero(), std::numbers::pi, 0.0, 0.0);
  Pose pose = is_down(frame) ? ours_from_frd : Pose::Identity();
  if (axes_of(frame) == FrameAxes::kOptical) pose.linear() = ours_from_optical().transpose();
  std::size_t at = place->second;
  for (std::size_t length = 0; length < kMaxChain && !is_vehicle_frame(names_[at]); ++length) {
    const Transforms* const link = parents[at];
    if (link == nullptr || !never_moves(link->poses)) return std::nullopt;
    pose = link->poses.front().map_from_body * pose;
    at = link->parent;
  }
  if (at == place->second || !is_vehicle_frame(names_[at])) return std::nullopt;
  if (is_down(names_[at])) pose = ours_from_frd * pose;
  return Mount{names_[at], pose};
}

std::string TfTree::unjoined_text() const {
  std::string text;
  const std::vector<const Transforms*> parents = main_parents();
  std::string fixed;
  for (const std::string& name : names_) {
    if (is_fixed_frame(name) && fixed.empty()) fixed = name;
  }
  for (std::size_t frame = 0; frame < names_.size(); ++frame) {
    if (!is_base_link(names_[frame])) continue;
    std::size_t root = frame;
    for (std::size_t length = 0; length < kMaxChain && parents[root] != nullptr; ++length) {
      if (is_fixed_frame(names_[root])) break;
      root = parents[root]->parent;
    }
    if (is_fixed_frame(names_[root])) continue;
    text = fmt::format("tf does not join {} to {}", names_[frame],
                       fixed.empty() ? std::string("a fixed frame (map, odom, world)") : fixed);
    break;
  }
  if (left_out_ > 0) {
    text += fmt::format("{}{} transforms of tf are left out, of more than {} frames or of no numbers",
                        text.empty() ? "" : "; ", left_out_, kMaxFrames);
  }
  return text;
}

}  // namespace pingvox
