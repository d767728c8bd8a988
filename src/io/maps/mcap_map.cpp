#include "pingvox/io/mcap_map.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "base/without_exceptions.hpp"
#include "io/internal/ros2_messages.hpp"
#include "io/maps/mcap_writer.hpp"
#include "io/maps/message_parts.hpp"
#include "io/maps/occupied_leaves.hpp"
#include "io/maps/shades.hpp"
#include "pingvox/analysis/slice.hpp"

namespace pingvox {
namespace {

constexpr std::string_view kMapFrame = "map", kBodyFrame = "base_link", kSonarFrame = "sonar";

/// Boxes of voxels, each on a topic of its own: a viewer shows the last message of a topic.
constexpr std::size_t kMaxVoxelTopics = 64;
constexpr std::array<std::int64_t, 3> kVoxelEdges = {32, 64, 128};

/// What the occupied cells span [m].
struct OccupiedBox {
  Eigen::Vector3d low_m = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()), high_m = -low_m;
};

OccupiedBox occupied_box(const OccupancyMap& map) {
  OccupiedBox box;
  for_each_occupied(map, [&](const Leaf& leaf) {
    box.low_m = box.low_m.array().min(leaf.centre_m().array() - leaf.edge_m() / 2.0);
    box.high_m = box.high_m.array().max(leaf.centre_m().array() + leaf.edge_m() / 2.0);
  });
  return box;
}

using BoxIndex = std::array<std::int64_t, 3>;

/// Calls `visit(BoxIndex)` for each box of `edge_m` that a leaf overlaps.
template <class Visitor>
void for_each_box_of(const Leaf& leaf, const Eigen::Vector3d& low_m, double edge_m, Visitor visit) {
  const double half_m = leaf.edge_m() / 2.0, inside_m = leaf.lattice->resolution_m() / 4.0;
  BoxIndex first{}, last{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double middle_m = leaf.centre_m()[static_cast<Eigen::Index>(axis)] - low_m[static_cast<Eigen::Index>(axis)];
    first[axis] = static_cast<std::int64_t>(std::floor((middle_m - half_m + inside_m) / edge_m));
    last[axis] = static_cast<std::int64_t>(std::floor((middle_m + half_m - inside_m) / edge_m));
  }
  for (std::int64_t z = first[2]; z <= last[2]; ++z) {
    for (std::int64_t y = first[1]; y <= last[1]; ++y) {
      for (std::int64_t x = first[0]; x <= last[0]; ++x) visit(BoxIndex{x, y, z});
    }
  }
}

/// The boxes in which something is occupied, and their edge in cells.
struct VoxelBoxes {
  std::int64_t edge = 0;
  std::set<BoxIndex> boxes;
};

/// nullopt: there are too many of the largest.
std::optional<VoxelBoxes> voxel_boxes(const OccupancyMap& map, const OccupiedBox& span) {
  for (const std::int64_t edge : kVoxelEdges) {
    const double edge_m = static_cast<double>(edge) * map.lattice().resolution_m();
    VoxelBoxes found{edge, {}};
    for_each_occupied(map, [&](const Leaf& leaf) {
      if (found.boxes.size() > kMaxVoxelTopics) return;
      // Of a leaf that is larger than all boxes together the first ones are enough.
      if (leaf.edge_m() > edge_m * static_cast<double>(kMaxVoxelTopics)) {
        for (std::int64_t i = 0; i <= static_cast<std::int64_t>(kMaxVoxelTopics); ++i) found.boxes.insert({i, 0, 0});
        return;
      }
      for_each_box_of(leaf, span.low_m, edge_m, [&](const BoxIndex& index) {
        if (found.boxes.size() <= kMaxVoxelTopics) found.boxes.insert(index);
      });
    });
    if (found.boxes.size() <= kMaxVoxelTopics) return found;
  }
  return std::nullopt;
}

/// The cells of one box.
VoxelBox voxels_in(const OccupancyMap& map, const OccupiedBox& span, std::int64_t edge, const BoxIndex& index) {
  const double cell_m = map.lattice().resolution_m(), edge_m = static_cast<double>(edge) * cell_m;
  VoxelBox box;
  box.corner_m = span.low_m + edge_m * Eigen::Vector3d(static_cast<double>(index[0]), static_cast<double>(index[1]),
                                                       static_cast<double>(index[2]));
  box.cell_m = cell_m;
  box.edge = static_cast<std::uint32_t>(edge);
  box.data.assign(static_cast<std::size_t>(edge * edge * edge) * VoxelBox::kCellBytes, '\0');
  const double range_m = span.high_m.z() - span.low_m.z();
  // A quarter of a cell smaller: the faces of its neighbours do not count.
  const Eigen::Vector3d inside_m = Eigen::Vector3d::Constant(cell_m / 4.0);
  const Box inner{box.corner_m + inside_m, box.corner_m + Eigen::Vector3d::Constant(edge_m) - inside_m};
  for_each_leaf(map, {.max_depth = std::nullopt, .box = inner}, [&](const Leaf& leaf) {
    if (classify(leaf.belief, map.options().thresholds) != Occupancy::kOccupied) return;
    std::string cell;
    append_little_endian(cell, leaf.belief.value());
    for (const double part : shade_at((leaf.centre_m().z() - span.low_m.z()) / range_m)) {
      cell.push_back(static_cast<char>(std::lround(part * 255.0)));
    }
    cell.push_back('\xff');
    std::array<std::int64_t, 3> first{}, end{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto at = static_cast<Eigen::Index>(axis);
      const double low = (leaf.centre_m()[at] - leaf.edge_m() / 2.0 - box.corner_m[at]) / cell_m;
      first[axis] = std::max<std::int64_t>(0, std::llround(low));
      end[axis] = std::min<std::int64_t>(edge, std::llround(low + leaf.edge_m() / cell_m));
    }
    for (std::int64_t z = first[2]; z < end[2]; ++z) {
      for (std::int64_t y = first[1]; y < end[1]; ++y) {
        for (std::int64_t x = first[0]; x < end[0]; ++x) {
          box.data.replace(static_cast<std::size_t>((z * edge + y) * edge + x) * VoxelBox::kCellBytes,
                           VoxelBox::kCellBytes, cell);
        }
      }
    }
  });
  return box;
}

/// The bins of a beam along its axis.
PackedPoints points_of(const Beam& beam) {
  PackedPoints points{{"x", "y", "z", "intensity"}, {}};
  const double cosine = std::cos(beam.bearing_rad), sine = std::sin(beam.bearing_rad);
  for (std::size_t bin = 0; bin < beam.intensities.size(); ++bin) {
    const double range_m = (static_cast<double>(bin) + 0.5) * beam.bin_length_m;
    for (const double value : {range_m * cosine, range_m * sine, 0.0, static_cast<double>(beam.intensities[bin])}) {
      append_little_endian(points.data, static_cast<float>(value));
    }
  }
  return points;
}

Result<std::uint64_t> nanoseconds_of(double time_s) {
  constexpr double kLast_s = 9.2e9;  // ROS has signed nanoseconds
  if (!(time_s >= 0.0 && time_s < kLast_s)) {
    return fail(Error::Code::kUnsupported,
                fmt::format("a time of {} s cannot be written: it must be 0 to 9.2e9", time_s));
  }
  const double whole_s = std::floor(time_s);
  return static_cast<std::uint64_t>(whole_s) * MessageStamp::kSecond_ns +
         static_cast<std::uint64_t>((time_s - whole_s) * static_cast<double>(MessageStamp::kSecond_ns));
}

/// How subscribers get messages when the file is played by ROS: reliably; maps also when they come late.
std::string qos_text(bool is_kept) {
  constexpr std::string_view kInfinite = "    sec: 9223372036\n    nsec: 854775807\n";
  return fmt::format(
      "- history: 1\n  depth: {}\n  reliability: 1\n  durability: {}\n  deadline:\n{}  lifespan:\n{}  liveliness: 1\n"
      "  liveliness_lease_duration:\n{}  avoid_ros_namespace_conventions: false\n",
      is_kept ? 1 : 10, is_kept ? 1 : 2, kInfinite, kInfinite, kInfinite);
}

/// Writes all messages of one file.
class MapRecording {
 public:
  MapRecording(const OccupancyMap& map, const McapContents& contents, McapMessages messages, std::ostream& out)
      : map_(map), contents_(contents), is_ros_(messages == McapMessages::kRos2), writer_(out, is_ros_ ? "ros2" : "") {}

  Result<McapCounts> write() {
    Result<std::optional<Beam>> beam = std::nullopt;
    if (contents_.beams != nullptr) beam = contents_.beams->next();
    if (!beam) return tl::unexpected(beam.error());
    double first_s = contents_.path ? contents_.path->poses().front().time_s : 0.0;
    if (*beam) first_s = contents_.path ? std::min(first_s, (*beam)->time_s) : (*beam)->time_s;
    const Result<std::uint64_t> first_ns = nanoseconds_of(first_s);
    if (!first_ns) return tl::unexpected(first_ns.error());
    start_ns_ = *first_ns;
    Result<void> done = write_map_itself();
    if (done) done = write_path();
    if (done && contents_.beams != nullptr) done = write_beams(*std::move(beam));
    if (done) done = write_transforms_until(std::numeric_limits<double>::infinity());
    if (done) done = writer_.finish();
    if (!done) return tl::unexpected(done.error());
    return counts_;
  }

 private:
  MessageStamp at_start(std::string_view frame = kMapFrame) const { return {start_ns_, frame}; }

  std::uint16_t channel(std::string topic, const std::string& foxglove_type, const std::string& ros_type,
                        bool is_kept) {
    if (!is_ros_) {
      return writer_.add_channel({std::move(topic),
                                  "foxglove." + foxglove_type,
                                  "protobuf",
                                  foxglove::schema_of(foxglove_type),
                                  "protobuf",
                                  {}});
    }
    return writer_.add_channel(
        {std::move(topic),
         ros_type,
         "ros2msg",
         ros2::schema_of(ros_type),
         "cdr",
         {{"offered_qos_profiles", qos_text(is_kept)}, {"topic_type_hash", std::string(ros2::hash_of(ros_type))}}});
  }

  Result<void> add(std::uint16_t channel, std::uint64_t time_ns, const std::string& message) {
    ++counts_.messages;
    return writer_.add(channel, time_ns, message);
  }

  Result<void> write_map_itself() {
    if (is_ros_) return write_ros_map();
    const Result<Raster<Occupancy>> slice = slice_of(map_, {});
    if (!slice) return tl::unexpected(slice.error());
    const Result<PackedPoints> points = occupied_points(map_);
    if (!points) return tl::unexpected(points.error());
    const std::uint16_t cloud = channel("/cloud", "PointCloud", {}, true);
    const std::uint16_t grid = channel("/grid", "Grid", {}, true);
    Result<void> done = add(cloud, start_ns_, foxglove::point_cloud(at_start(), *points));
    if (done) done = add(grid, start_ns_, foxglove::grid(at_start(), *slice));
    return done ? write_voxels() : done;
  }

  Result<void> write_ros_map() {
    const Result<std::vector<Ros2Message>> messages = ros2_map_messages(map_, start_ns_, kMapFrame);
    if (!messages) return tl::unexpected(messages.error());
    for (const Ros2Message& message : *messages) {
      const std::uint16_t topic = channel(std::string(message.topic), {}, std::string(message.type), true);
      if (auto done = add(topic, start_ns_, message.bytes); !done) return done;
    }
    return {};
  }

  Result<void> write_voxels() {
    const OccupiedBox span = occupied_box(map_);
    const std::optional<VoxelBoxes> found = voxel_boxes(map_, span);
    if (!found) {
      return fail(Error::Code::kLimit,
                  fmt::format("its occupied cells are in more than {} boxes of {} cells a side, which VoxelGrid may "
                              "have; larger cells (cut_depth, resolution_m) need fewer",
                              kMaxVoxelTopics, kVoxelEdges.back()));
    }
    std::size_t box = 0;
    for (const BoxIndex& index : found->boxes) {
      const std::uint16_t topic = channel(fmt::format("/voxels/{}", box++), "VoxelGrid", {}, true);
      const std::string message = foxglove::voxel_grid(at_start(), voxels_in(map_, span, found->edge, index));
      if (auto done = add(topic, start_ns_, message); !done) return done;
    }
    return {};
  }

  Result<void> write_path() {
    if (!contents_.path && contents_.beams == nullptr) return {};
    transforms_ = channel("/tf", "FrameTransform", "tf2_msgs/msg/TFMessage", false);
    if (!contents_.path) return add_transform(start_ns_, kMapFrame, kBodyFrame, Pose::Identity());
    const std::vector<StampedPose>& poses = contents_.path->poses();
    for (const StampedPose& pose : poses) {
      if (const auto time_ns = nanoseconds_of(pose.time_s); !time_ns) return tl::unexpected(time_ns.error());
    }
    const std::uint16_t path = channel("/path", "PosesInFrame", "nav_msgs/msg/Path", true);
    counts_.poses = poses.size();
    return add(path, start_ns_, is_ros_ ? ros2::poses(at_start(), poses) : foxglove::poses(at_start(), poses));
  }

  Result<void> add_transform(std::uint64_t time_ns, std::string_view parent, std::string_view child,
                             const Pose& parent_from_child) {
    const MessageStamp stamp{time_ns, parent};
    return add(transforms_, time_ns,
               is_ros_ ? ros2::transform(stamp, child, parent_from_child)
                       : foxglove::transform(stamp, child, parent_from_child));
  }

  /// Those of the path that were not yet written.
  Result<void> write_transforms_until(double time_s) {
    if (!contents_.path) return {};
    const std::vector<StampedPose>& poses = contents_.path->poses();
    for (; next_pose_ < poses.size() && poses[next_pose_].time_s <= time_s; ++next_pose_) {
      const std::uint64_t time_ns = nanoseconds_of(poses[next_pose_].time_s).value_or(start_ns_);
      const auto done = add_transform(time_ns, kMapFrame, kBodyFrame, poses[next_pose_].map_from_body);
      if (!done) return done;
    }
    return {};
  }

  Result<void> write_beams(std::optional<Beam> beam) {
    if (auto done = add_transform(start_ns_, kBodyFrame, kSonarFrame, contents_.body_from_sonar); !done) return done;
    const std::uint16_t topic = channel("/beams", "PointCloud", "sensor_msgs/msg/PointCloud2", false);
    while (beam) {
      const Result<std::uint64_t> time_ns = nanoseconds_of(beam->time_s);
      if (!time_ns) return tl::unexpected(time_ns.error());
      Result<void> done = write_transforms_until(beam->time_s);
      const MessageStamp stamp{*time_ns, kSonarFrame};
      const PackedPoints points = points_of(*beam);
      if (done) {
        done = add(topic, *time_ns, is_ros_ ? ros2::point_cloud(stamp, points) : foxglove::point_cloud(stamp, points));
      }
      if (!done) return done;
      ++counts_.beams;
      Result<std::optional<Beam>> next = contents_.beams->next();
      if (!next) return tl::unexpected(next.error());
      beam = *std::move(next);
    }
    return {};
  }

  const OccupancyMap& map_;
  const McapContents& contents_;
  bool is_ros_;
  McapWriter writer_;
  McapCounts counts_;
  std::uint64_t start_ns_ = 0;
  std::uint16_t transforms_ = 0;
  std::size_t next_pose_ = 0;
};

}  // namespace

Result<McapCounts> write_mcap(const OccupancyMap& map, const McapContents& contents, McapMessages messages,
                              std::ostream& out) {
  return detail::without_exceptions([&] { return MapRecording(map, contents, messages, out).write(); });
}

}  // namespace pingvox
