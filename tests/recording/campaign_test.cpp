#include "pingvox/recording/campaign.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "pingvox/geometry/degree.hpp"
#include "pingvox/nav/nav_trajectory.hpp"
#include "recording/dive.hpp"
#include "support/folder.hpp"

namespace pingvox::test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

/// 2023-11-14 22:13:20 UTC.
constexpr double kDay_s = 1.7e9;
const Eigen::Vector3d kHarbour{54.3 * kDegree_rad, 10.1 * kDegree_rad, 0.0};

/// Five stretches of 12 s of one way through a harbour, each a dive on a clock of its own.
class DivesInFolders : public testing::Test {
 protected:
  enum class Position { kFix, kLocal, kBoth };

  /// The way of dive `number`, which begins at `start_s`.
  Trajectory way(int number, double start_s) const {
    const Trajectory all = follow_route(scene_.loop, 60.0, {});
    std::vector<StampedPose> poses;
    for (const StampedPose& pose : all.poses()) {
      const double time_s = pose.time_s - 12.0 * number;
      if (time_s >= 0.0 && time_s <= 12.0) poses.push_back({start_s + time_s, pose.map_from_body});
    }
    return *Trajectory::make(std::move(poses));
  }

  void write(const std::string& name, const std::string& text) const {
    fs::create_directories(fs::path(path(name)).parent_path());
    std::ofstream(path(name)) << text;
  }
  std::string path(const std::string& name) const { return folder_.path(name); }

  void write_log(const std::string& name, int number, double start_s) const {
    SonarOptions sonar;
    sonar.beams_per_turn = 60;
    sonar.bins = 100;
    sonar.bin_length_m = 0.1;
    sonar.seed = static_cast<std::uint64_t>(number) + 1;
    SonarSimulator beams(scene_.world, way(number, start_s), sonar, 3);
    std::ostringstream log;
    EXPECT_TRUE(write_csv(beams, log));
    write(name, log.str());
  }

  /// Navigation of the dives `from`..`to` - 1, the first of which begins at `start_s`, each 100 s after the one before.
  void write_nav(const std::string& name, int from, int to, double start_s, Position position = Position::kFix,
                 NavClock clock = NavClock::kUnix, const std::string& source = "GPS") const {
    NavSource fixes{source, NavQuantity::kFix, {}}, places{source, NavQuantity::kPosition, {}},
        turns{"AHRS", NavQuantity::kAttitude, {}};
    Eigen::Vector3d local = Eigen::Vector3d::Zero();
    for (int number = from; number < to; ++number) {
      const Trajectory poses = way(number, start_s + 100.0 * (number - from));
      if (number == from) local = poses.poses().front().map_from_body.translation();
      for (const StampedPose& pose : poses.poses()) {
        const Eigen::Vector3d place = pose.map_from_body.translation();
        fixes.samples.push_back({pose.time_s, fix_of_position(place, kHarbour)});
        places.samples.push_back({pose.time_s, place - Eigen::Vector3d(local.x(), local.y(), 0.0)});
        turns.samples.push_back({pose.time_s, rpy_of(pose.map_from_body.rotation())});
      }
    }
    std::vector<NavSource> sources = {turns};
    if (position != Position::kLocal) sources.push_back(fixes);
    if (position != Position::kFix) sources.push_back(places);
    std::ostringstream text;
    EXPECT_TRUE(write_nav_csv(*NavLog::make(sources, clock), text));
    write(name, text.str());
  }

  /// Dives with a log and a navigation log each.
  void write_dives(int count) const {
    for (int number = 0; number < count; ++number) {
      const double start_s = kDay_s + 100.0 * number;
      write_log("sonar/dive" + std::to_string(number) + ".csv", number, start_s);
      write_nav("nav/nav" + std::to_string(number) + ".csv", number, number + 1, start_s);
    }
  }

  Campaign planned(const CampaignOptions& options = kOptions) const {
    auto campaign = plan_campaign({path("sonar")}, {path("nav")}, options);
    EXPECT_TRUE(campaign) << campaign.error().message;
    return campaign ? *std::move(campaign) : Campaign{};
  }

  /// The map of all dives by way of a folder of kept maps.
  std::string map_by(const std::string& kept, const Campaign& campaign) const {
    fs::create_directories(path(kept));
    const auto sum = sum_of_maps(0, campaign.dives.size(), [&](std::size_t number) {
      return kept_or_new_map(campaign, number, kOptions, path(kept)).map([](DiveMap dive) {
        return std::optional(std::move(dive.map));
      });
    });
    EXPECT_TRUE(sum && *sum);
    return bytes_of_map(**sum);
  }

  static inline const CampaignOptions kOptions{.map = {.resolution_m = 0.2}, .made_with = "a test"};
  const Folder folder_;
  const Scene scene_ = harbour_scene({});
};

TEST_F(DivesInFolders, ArePairedByTime) {
  write_dives(3);
  const Campaign campaign = planned();
  ASSERT_THAT(campaign.dives, SizeIs(3));
  for (int i = 0; i < 3; ++i) {
    const auto& dive = campaign.dives[static_cast<std::size_t>(i)];
    EXPECT_EQ(dive.log, path("sonar/dive" + std::to_string(i) + ".csv"));
    EXPECT_EQ(dive.name, "dive" + std::to_string(i) + ".csv");
    EXPECT_THAT(dive.navs, ElementsAre(path("nav/nav" + std::to_string(i) + ".csv")));
  }
  EXPECT_THAT(campaign.logs, IsEmpty());
  EXPECT_THAT(campaign.navs, IsEmpty());
  EXPECT_EQ(campaign.forecast.resolution_m, 0.2);
}

TEST_F(DivesInFolders, MapOfOneIsThatOfItsRecording) {
  write_dives(1);
  const Campaign campaign = planned();
  const auto dive = map_dive(campaign, 0, kOptions);
  ASSERT_TRUE(dive) << dive.error().message;
  const auto alone = Recording::open({path("sonar/dive0.csv")}, {.nav = {path("nav/nav0.csv")}})
                         .and_then([](const Recording& recording) { return build_map(recording, kOptions.map); });
  ASSERT_TRUE(alone) << alone.error().message;
  EXPECT_EQ(bytes_of_map(dive->map), bytes_of_map(alone->map));
  EXPECT_EQ(dive->beams, alone->report.beams);
  EXPECT_EQ(dive->axes, MapAxes::kEastNorth);
}

// Kills maps that stay in the frames of their own first fixes.
TEST_F(DivesInFolders, AreMappedInTheFrameOfTheFirstOne) {
  write_dives(3);
  const Campaign campaign = planned();
  ASSERT_TRUE(campaign.origin);
  const Eigen::Vector3d start = position_of_fix(campaign.origin->fix, kHarbour);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto dive = map_dive(campaign, i, kOptions);
    ASSERT_TRUE(dive) << dive.error().message;
    EXPECT_EQ(dive->frame, DiveMap::Frame::kShared);
    // The same along the true way, moved as a whole; its heights are above the first fix, too.
    const Trajectory true_way = way(static_cast<int>(i), kDay_s + 100.0 * static_cast<double>(i));
    std::vector<StampedPose> poses = true_way.poses();
    for (StampedPose& pose : poses) pose.map_from_body.pretranslate(Eigen::Vector3d(-start));
    OccupancyMap truth(kOptions.map);
    auto beams = open_beams(*ByteStream::open(campaign.dives[i].log));
    ASSERT_TRUE(beams);
    const auto built = build_map(**beams, *Trajectory::make(std::move(poses)), {}, truth);
    ASSERT_TRUE(built);
    const auto true_bounds = truth.bounds(), bounds = dive->map.bounds();
    EXPECT_LT((true_bounds->min - bounds->min).norm(), 0.41);
    EXPECT_LT((true_bounds->max - bounds->max).norm(), 0.41);
    const auto expected = static_cast<double>(truth.counts().occupied_cells);
    EXPECT_NEAR(static_cast<double>(dive->map.counts().occupied_cells), expected, 0.05 * expected);
    EXPECT_GT(expected, 100.0);
  }
}

// Kills a frame that is taken from the fixes of one, while positions in metres lie elsewhere.
TEST_F(DivesInFolders, WithLocalPositionsAreMovedByTheirFixes) {
  write_log("sonar/a.csv", 0, kDay_s);
  write_log("sonar/b.csv", 1, kDay_s + 100.0);
  write_nav("nav/a.csv", 0, 1, kDay_s);
  write_nav("nav/b.csv", 1, 2, kDay_s + 100.0);
  const auto by_fixes = map_dive(planned(), 1, kOptions);
  write_nav("nav/b.csv", 1, 2, kDay_s + 100.0, Position::kBoth);
  const auto by_places = map_dive(planned(), 1, kOptions);
  ASSERT_TRUE(by_fixes && by_places);
  EXPECT_EQ(by_places->frame, DiveMap::Frame::kShared);
  const auto a = by_fixes->map.bounds(), b = by_places->map.bounds();
  EXPECT_LT((a->min - b->min).head<2>().norm(), 0.41);
  EXPECT_LT((a->max - b->max).head<2>().norm(), 0.41);
  write_nav("nav/b.csv", 1, 2, kDay_s + 100.0, Position::kLocal);
  const auto alone = map_dive(planned(), 1, kOptions);
  ASSERT_TRUE(alone);
  EXPECT_EQ(alone->frame, DiveMap::Frame::kOwn);
}

TEST_F(DivesInFolders, WithoutFixesShareTheFrameOfOneNavigation) {
  write_log("sonar/a.csv", 0, kDay_s);
  write_log("sonar/b.csv", 1, kDay_s + 100.0);
  write_log("sonar/c.csv", 2, kDay_s + 1000.0);
  write_nav("nav/ab.csv", 0, 2, kDay_s, Position::kLocal);
  write_nav("nav/c.csv", 2, 3, kDay_s + 1000.0, Position::kLocal);
  const Campaign campaign = planned();
  ASSERT_THAT(campaign.dives, SizeIs(3));
  EXPECT_EQ(campaign.dives[0].navs, campaign.dives[1].navs);
  EXPECT_FALSE(campaign.origin);
  using Frame = DiveMap::Frame;
  EXPECT_EQ(map_dive(campaign, 0, kOptions)->frame, Frame::kShared);
  EXPECT_EQ(map_dive(campaign, 1, kOptions)->frame, Frame::kShared);
  EXPECT_EQ(map_dive(campaign, 2, kOptions)->frame, Frame::kOwn);
}

TEST_F(DivesInFolders, AreAddedInAnOrderThatInterruptionsDoNotChange) {
  write_dives(5);
  const Campaign campaign = planned();
  const std::string in_one_go = map_by("kept", campaign);
  std::vector<OccupancyMap> maps;
  for (std::size_t i = 0; i < 5; ++i) maps.push_back(map_dive(campaign, i, kOptions)->map);
  OccupancyMap first = maps[0], second = maps[2];
  ASSERT_TRUE(first.merge(maps[1]) && second.merge(maps[3]) && first.merge(second) && first.merge(maps[4]));
  EXPECT_EQ(in_one_go, bytes_of_map(first)) << "((0 + 1) + (2 + 3)) + 4";
  for (std::size_t done = 0; done <= 5; ++done) {
    const std::string kept = "kept" + std::to_string(done);
    fs::create_directories(path(kept));
    for (std::size_t i = 0; i < done; ++i) {
      const auto dive = kept_or_new_map(campaign, i, kOptions, path(kept));
      ASSERT_TRUE(dive);
      EXPECT_FALSE(dive->was_kept);
    }
    const Campaign resumed = planned();
    for (std::size_t i = 0; i < 5; ++i) {
      EXPECT_EQ(read_kept_map(resumed, i, kOptions, path(kept)).has_value(), i < done);
    }
    EXPECT_EQ(map_by(kept, resumed), in_one_go) << done;
  }
}

TEST_F(DivesInFolders, KeptMapsTellWhatNewOnesDo) {
  write_dives(2);
  const Campaign campaign = planned();
  fs::create_directories(path("kept"));
  const auto made = kept_or_new_map(campaign, 1, kOptions, path("kept"));
  const auto kept = kept_or_new_map(campaign, 1, kOptions, path("kept"));
  ASSERT_TRUE(made && kept);
  EXPECT_FALSE(made->was_kept);
  EXPECT_TRUE(kept->was_kept);
  EXPECT_EQ(bytes_of_map(kept->map), bytes_of_map(made->map));
  EXPECT_EQ(kept->axes, made->axes);
  EXPECT_EQ(kept->frame, made->frame);
  EXPECT_EQ(kept->beams, made->beams);
  EXPECT_EQ(kept->echoes, made->echoes);
  EXPECT_EQ(kept->no_pose, made->no_pose);
  EXPECT_GT(kept->echoes, 50U);
}

TEST_F(DivesInFolders, AreMappedAgainWhenWhatTheyAreMadeOfChanges) {
  write_dives(2);
  const Campaign campaign = planned();
  map_by("kept", campaign);
  const auto is_kept = [&](const Campaign& of, std::size_t number, const CampaignOptions& options) {
    return read_kept_map(of, number, options, path("kept")).has_value();
  };
  ASSERT_TRUE(is_kept(campaign, 0, kOptions));
  CampaignOptions others = kOptions;
  others.made_with = "another test";
  EXPECT_FALSE(is_kept(campaign, 0, others));
  others.made_with = "a test\n";
  EXPECT_FALSE(is_kept(campaign, 0, others));
  CampaignOptions coarser = kOptions;
  coarser.map.resolution_m = 0.3;
  EXPECT_FALSE(is_kept(planned(coarser), 0, coarser));
  const auto later = [](const std::string& file) {
    fs::last_write_time(file, fs::last_write_time(file) + std::chrono::seconds(2));
  };
  later(path("sonar/dive1.csv"));
  EXPECT_TRUE(is_kept(planned(), 0, kOptions));
  EXPECT_FALSE(is_kept(planned(), 1, kOptions));
  map_by("kept", planned());
  later(path("nav/nav1.csv"));
  EXPECT_FALSE(is_kept(planned(), 1, kOptions));
  map_by("kept", planned());
  ASSERT_TRUE(is_kept(planned(), 1, kOptions));
  // Another first dive has another first fix.
  fs::rename(path("sonar/dive0.csv"), path("sonar/dive2.csv"));
  EXPECT_FALSE(is_kept(planned(), 0, kOptions));
  fs::rename(path("sonar/dive2.csv"), path("sonar/dive0.csv"));
  ASSERT_TRUE(is_kept(planned(), 1, kOptions));
  fs::resize_file(path("kept/dive1.csv.pvx"), fs::file_size(path("kept/dive1.csv.pvx")) - 1);
  EXPECT_FALSE(is_kept(planned(), 1, kOptions)) << "a map that is damaged";
}

TEST_F(DivesInFolders, NameWhatCannotBePaired) {
  write_dives(2);
  write_log("sonar/lonely.csv", 0, kDay_s + 5000.0);
  write("sonar/damaged.csv", "time_s,bearing_rad,bin_length_m,intensities\n1,x,y,z\n");
  write("sonar/notes.md", "hello\n");
  write_nav("nav/unused.csv", 0, 1, kDay_s - 3000.0);
  const Campaign campaign = planned();
  EXPECT_THAT(campaign.dives, SizeIs(2));
  ASSERT_THAT(campaign.logs, SizeIs(2));
  EXPECT_EQ(campaign.logs[0].path, path("sonar/damaged.csv"));
  EXPECT_EQ(campaign.logs[1].path, path("sonar/lonely.csv"));
  EXPECT_THAT(campaign.logs[1].reason, HasSubstr("no navigation at its time: of " + path("nav/nav1.csv")));
  ASSERT_THAT(campaign.navs, SizeIs(1));
  EXPECT_EQ(campaign.navs[0].path, path("nav/unused.csv"));
  EXPECT_THAT(campaign.unknown, ElementsAre(path("sonar/notes.md")));
}

TEST_F(DivesInFolders, MayBeNoneAtAll) {
  fs::create_directories(path("sonar"));
  fs::create_directories(path("nav"));
  const Campaign campaign = planned();
  EXPECT_THAT(campaign.dives, IsEmpty());
  const auto sum = sum_of_maps(0, 0, [](std::size_t) { return std::optional<OccupancyMap>(); });
  ASSERT_TRUE(sum);
  EXPECT_FALSE(*sum);
  const auto without_nav = plan_campaign({path("missing/")}, {path("nav")}, kOptions);
  EXPECT_THAT(without_nav.error().message, HasSubstr(path("nav") + ": there is no navigation"));
  CampaignOptions flat = kOptions;
  flat.map.depth = 0;
  EXPECT_EQ(plan_campaign({path("sonar")}, {path("nav")}, flat).error().code, Error::Code::kBadOption);
  CampaignOptions with_nav = kOptions;
  with_nav.recording.nav = {path("nav/nav0.csv")};
  EXPECT_EQ(plan_campaign({path("sonar")}, {path("nav")}, with_nav).error().code, Error::Code::kBadOption);
}

TEST_F(DivesInFolders, OfOneNameInTwoFoldersAreTwo) {
  write_log("sonar/monday/dive.csv", 0, kDay_s);
  write_log("sonar/tuesday/dive.csv", 1, kDay_s + 100.0);
  write_log("sonar/tuesday_dive.csv", 2, kDay_s + 200.0);
  write_nav("nav/all.csv", 0, 3, kDay_s);
  const Campaign campaign = planned();
  ASSERT_THAT(campaign.dives, SizeIs(3));
  EXPECT_EQ(campaign.dives[0].name, "monday_dive.csv");
  EXPECT_EQ(campaign.dives[1].name, "tuesday_dive.csv");
  EXPECT_EQ(campaign.dives[2].name, "tuesday_dive.csv-2");
}

// What a failed dive takes out of a sum must not move the others to other places in it.
TEST(SumOfMaps, HasTheSameOrderWhereMapsAreMissing) {
  const auto text = [](std::size_t from, std::size_t to) {
    const auto of = [](const auto& self, std::size_t a, std::size_t b) -> std::string {
      if (b - a == 1) return std::to_string(a);
      const std::size_t middle = middle_of_sum(a, b);
      return "(" + self(self, a, middle) + self(self, middle, b) + ")";
    };
    return of(of, from, to);
  };
  EXPECT_EQ(text(0, 2), "(01)");
  EXPECT_EQ(text(0, 3), "((01)2)");
  EXPECT_EQ(text(0, 7), "(((01)(23))((45)6))");
  EXPECT_EQ(text(4, 8), "((45)(67))");
  std::vector<std::size_t> asked;
  const auto sum = sum_of_maps(0, 4, [&](std::size_t number) -> Result<std::optional<OccupancyMap>> {
    asked.push_back(number);
    if (number != 2) return std::nullopt;
    OccupancyMap map;
    map.edit().update(Key{1, 2, 3}, LogOdds(0.5F));
    return map;
  });
  ASSERT_TRUE(sum && *sum);
  EXPECT_THAT(asked, ElementsAre(0U, 1U, 2U, 3U));
  EXPECT_EQ((*sum)->counts().leaves, 1U);
}

}  // namespace
}  // namespace pingvox::test
