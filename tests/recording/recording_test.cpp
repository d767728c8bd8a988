#include "pingvox/recording/recording.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numbers>

#include "pingvox/io/tum.hpp"
#include "recording/dive.hpp"
#include "support/folder.hpp"

namespace pingvox::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const MapOptions kCoarse{.resolution_m = 0.2};

TEST(Recording, MapsALogAsItsPartsDoByHand) {
  const Dive dive = harbour_dive();
  const auto recording = Recording::open({dive.log}, {.nav = {dive.nav}, .nav_offset_s = 0.0});
  ASSERT_TRUE(recording) << recording.error().message;
  const auto mapped = build_map(*recording, kCoarse);
  ASSERT_TRUE(mapped) << mapped.error().message;

  const auto nav = read_nav(dive.nav);
  const auto odometry = odometry_of(nav->log, {});
  OccupancyMap by_hand(kCoarse);
  auto beams = open_beams(dive.log);
  const auto report = build_map(**beams, odometry->odometry_from_body, {}, by_hand);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(bytes_of_map(mapped->map), bytes_of_map(by_hand));
  EXPECT_EQ(mapped->report.beams, report->beams);
  EXPECT_EQ(mapped->report.echoes, report->echoes);
  EXPECT_GT(report->echoes, 200U);
  ASSERT_TRUE(mapped->path.nav);
  EXPECT_EQ(mapped->path.nav->velocity, "DVL");
}

/// Some beams that reach `range_m`, in bins of 5 cm.
FileBytes beams_of_range(const std::string& name, int range_m) {
  std::string text = "time_s,bearing_rad,bin_length_m,intensities\n";
  for (int n = 0; n < 20; ++n) {
    text += std::to_string(n) + "," + std::to_string(0.1 * n) + ",0.05";
    for (int bin = 0; bin < 20 * range_m; ++bin) text += bin == 40 ? ",200" : ",1";
    text += '\n';
  }
  return {name, bytes_of(text)};
}

TEST(Recording, IsMappedInCellsThatFollowRangeAndBeam) {
  const auto resolution = [](const std::vector<InputFile>& logs, const MapOptions& map = {},
                             const BuildOptions& build = {}, RecordingOptions options = {}) {
    const auto mapped = Recording::open(logs, std::move(options)).and_then([&](const Recording& recording) {
      return build_map(recording, map, build);
    });
    EXPECT_TRUE(mapped) << mapped.error().message;
    EXPECT_EQ(mapped->map.lattice().resolution_m(), mapped->forecast.resolution_m);
    return mapped->forecast.resolution_m;
  };
  const FileBytes near = beams_of_range("near.csv", 5), far = beams_of_range("far.csv", 50);
  EXPECT_EQ(resolution({near}), 0.05);
  EXPECT_EQ(resolution({far}), 0.25);
  EXPECT_EQ(resolution({near, far}), 0.25);
  EXPECT_EQ(resolution({far, near}), 0.25);
  EXPECT_EQ(resolution({far}, {.resolution_m = 0.5}), 0.5) << "as asked";
  BuildOptions build;
  build.echo.max_range_m = 20.0;
  EXPECT_EQ(resolution({far}, {}, build), 0.1) << "nothing is mapped beyond";
  RecordingOptions narrow;
  narrow.head.beam_width_rad = 1.0 * std::numbers::pi / 180.0;
  EXPECT_EQ(resolution({far}, {}, {}, narrow), 0.1);
}

TEST(Recording, TellsWhatItsMapMayTake) {
  const auto cost = [](int range_m, double cell_m) {
    const auto forecast = Recording::open({beams_of_range("a.csv", range_m)}).and_then([&](const Recording& recording) {
      return forecast_map(recording, {.resolution_m = cell_m});
    });
    EXPECT_TRUE(forecast && forecast->cost);
    return *forecast->cost;
  };
  EXPECT_EQ(cost(10, 0.05).beams, 20.0);
  EXPECT_GT(cost(50, 0.05).seconds, 20.0 * cost(10, 0.05).seconds);
  EXPECT_GT(cost(50, 0.05).bytes, 6.0 * cost(50, 0.1).bytes);
}

TEST(Recording, CanBeReadAgainAndAgain) {
  const Dive dive = harbour_dive();
  const auto recording = Recording::open({dive.log}, {.nav = {dive.nav}});
  ASSERT_TRUE(recording) << recording.error().message;
  const auto one = build_map(*recording, kCoarse), two = build_map(*recording, kCoarse);
  ASSERT_TRUE(one && two);
  EXPECT_EQ(bytes_of_map(one->map), bytes_of_map(two->map));
}

TEST(Recording, OfFilesIsThatOfTheirBytes) {
  const Dive dive = harbour_dive();
  const Folder folder;
  for (const FileBytes& file : {dive.log, dive.nav}) {
    std::ofstream(folder.path(file.name), std::ios::binary)
        .write(reinterpret_cast<const char*>(file.bytes.data()), static_cast<std::streamsize>(file.bytes.size()));
  }
  const auto of_files = Recording::open({folder.path("dive.csv")}, {.nav = {folder.path("nav.csv")}})
                            .and_then([](const Recording& recording) { return build_map(recording, kCoarse); });
  const auto of_bytes = Recording::open({dive.log}, {.nav = {dive.nav}}).and_then([](const Recording& recording) {
    return build_map(recording, kCoarse);
  });
  ASSERT_TRUE(of_files) << of_files.error().message;
  ASSERT_TRUE(of_bytes) << of_bytes.error().message;
  EXPECT_EQ(bytes_of_map(of_files->map), bytes_of_map(of_bytes->map));
}

// Kills a sum that forgets a log, or counts one twice.
TEST(Recording, OfTwoLogsHasTheBeamsOfBoth) {
  const Dive dive = harbour_dive();
  const auto one = Recording::open({dive.log}).and_then([](const Recording& r) { return build_map(r, kCoarse); });
  const auto two =
      Recording::open({dive.log, dive.log}).and_then([](const Recording& r) { return build_map(r, kCoarse); });
  ASSERT_TRUE(one && two);
  EXPECT_EQ(two->logs.size(), 2U);
  EXPECT_EQ(two->report.beams, 2 * one->report.beams);
  EXPECT_EQ(two->report.echoes, 2 * one->report.echoes);
  EXPECT_EQ(two->report.first_s, one->report.first_s);
}

// Kills an offset that is not used, or used with the wrong sign: the clock of the navigation is put ahead.
TEST(Recording, IsTheSameWhateverTheClockOfItsNavigation) {
  const auto map_of = [](double delay_s) {
    const Dive dive = harbour_dive(delay_s);
    return Recording::open({dive.log}, {.nav = {dive.nav}, .nav_offset_s = -delay_s})
        .and_then([](const Recording& recording) { return build_map(recording, kCoarse); });
  };
  const auto on_time = map_of(0.0), ahead = map_of(64.0);  // so that sums of times are exact
  ASSERT_TRUE(on_time && ahead);
  EXPECT_EQ(bytes_of_map(on_time->map), bytes_of_map(ahead->map));
}

TEST(Recording, SaysHowTheClocksAreJoined) {
  const Dive dive = harbour_dive();
  const auto found = Recording::open({dive.log}, {.nav = {dive.nav}});
  const auto given = Recording::open({dive.log}, {.nav = {dive.nav}, .nav_offset_s = 2.5});
  ASSERT_TRUE(found && given);
  EXPECT_EQ(found->nav_offset()->by, NavOffset::By::kOneClock);
  EXPECT_EQ(found->nav_offset()->offset_s, 0.0);
  EXPECT_EQ(given->nav_offset()->by, NavOffset::By::kGiven);
  EXPECT_EQ(given->nav_offset()->offset_s, 2.5);
  ASSERT_EQ(found->nav().clocks.size(), 1U);
  EXPECT_EQ(found->nav().clocks.front().by, NavLogClock::By::kFirst);
}

// Kills a mount that is not used, or that of the build options, which would turn it twice.
TEST(Recording, TurnsAndMovesTheMapWithTheMount) {
  const Dive dive = harbour_dive();
  const Pose mount = pose_from_rpy({1.0, -2.0, 0.4}, 0.0, 0.0, std::numbers::pi / 2.0);
  const auto level = Recording::open({dive.log}).and_then([](const Recording& r) { return build_map(r, kCoarse); });
  BuildOptions build;
  build.body_from_sensor = mount;
  const auto mounted = Recording::open({dive.log}, {.body_from_sonar = mount}).and_then([&](const Recording& r) {
    return build_map(r, kCoarse, build);
  });
  ASSERT_TRUE(level && mounted);
  const Box a = *level->map.bounds(), b = *mounted->map.bounds();
  constexpr double kCells_m = 2 * 0.2;
  EXPECT_NEAR(b.max.x(), 1.0 - a.min.y(), kCells_m);
  EXPECT_NEAR(b.min.x(), 1.0 - a.max.y(), kCells_m);
  EXPECT_NEAR(b.max.y(), -2.0 + a.max.x(), kCells_m);
  EXPECT_NEAR(b.min.z(), 0.4 + a.min.z(), kCells_m);
}

// Kills the size of a beam that is taken from the build options where the head is known.
TEST(Recording, TakesTheBeamOfItsHead) {
  const Dive dive = harbour_dive();
  const DeviceProfile* const ping360 = find_device("ping360");
  ASSERT_NE(ping360, nullptr);
  const auto of_head = Recording::open({dive.log}, {.head = {.device = ping360}}).and_then([](const Recording& r) {
    return build_map(r, kCoarse);
  });
  const auto assumed = Recording::open({dive.log}).and_then([](const Recording& r) { return build_map(r, kCoarse); });
  ASSERT_TRUE(of_head && assumed);
  EXPECT_EQ(of_head->logs.front().beam.width_rad, ping360->beam_width_rad);
  EXPECT_FALSE(of_head->logs.front().assumes_beam);
  EXPECT_TRUE(assumed->logs.front().assumes_beam);
  EXPECT_EQ(assumed->logs.front().beam.width_rad, BeamModelOptions{}.width_rad);
}

TEST(Recording, NamesAllOptionsThatDoNotFit) {
  RecordingOptions options;
  options.nav_offset_s = 1.0;
  options.nav_sources = {{"DVL"}};
  options.nav_salinity = 35.0;
  options.background_m = -1.0;
  const auto recording = Recording::open({FileBytes{"x.csv", {}}}, options);
  ASSERT_FALSE(recording);
  EXPECT_EQ(recording.error().code, Error::Code::kBadOption);
  EXPECT_THAT(recording.error().message, AllOf(HasSubstr("nav_offset_s"), HasSubstr("nav_sources"),
                                               HasSubstr("nav_salinity"), HasSubstr("background_m")));
  options = {};
  options.poses = "poses.tum";
  options.nav = {"nav.csv"};
  EXPECT_THAT(Recording::open({"x.csv"}, options).error().message, HasSubstr("poses and nav exclude each other"));
  EXPECT_THAT(Recording::open({}).error().message, HasSubstr("no log given"));
}

TEST(Recording, ErrorsNameTheFileAndNoOptionOfTheCommandLine) {
  const Dive dive = harbour_dive();
  const FileBytes text{"notes.txt", bytes_of("This is no log.\n")};
  const FileBytes poses{"poses.tum", bytes_of("0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n")};
  const FileBytes depth{"depth.csv", bytes_of("time_s,source,quantity,x,y,z\n0,d,depth,1,,\n30,d,depth,1,,\n")};
  const auto message = [&](std::vector<InputFile> logs, RecordingOptions options) {
    const auto made = Recording::open(std::move(logs), std::move(options)).and_then([](const Recording& recording) {
      return build_map(recording, kCoarse);
    });
    return made ? std::string("no error") : made.error().message;
  };
  EXPECT_THAT(message({text}, {}), AllOf(HasSubstr("notes.txt: "), Not(HasSubstr("--"))));
  EXPECT_THAT(message({poses}, {}), AllOf(HasSubstr("poses.tum: "), HasSubstr("not a log"), Not(HasSubstr("--"))));
  EXPECT_THAT(message({dive.log}, {.nav = {poses}}),
              AllOf(HasSubstr("poses.tum: "), HasSubstr("not a navigation log"), Not(HasSubstr("--"))));
  EXPECT_THAT(message({dive.log}, {.nav = {depth}}),
              AllOf(HasSubstr("depth.csv: "), HasSubstr("no path"), Not(HasSubstr("--"))));
  EXPECT_THAT(message({dive.log}, {.nav = {dive.nav}, .nav_sources = {{"GPS"}}}),
              AllOf(HasSubstr("nav_sources"), HasSubstr("GPS"), Not(HasSubstr("--"))));
  EXPECT_THAT(message({"/nonexistent/dive.bin"}, {}), HasSubstr("/nonexistent/dive.bin"));
}

TEST(Recording, FollowsPosesOfAFile) {
  const Dive dive = harbour_dive();
  std::ostringstream tum;
  ASSERT_TRUE(write_tum(dive.truth, tum));
  const auto mapped = Recording::open({dive.log}, {.poses = FileBytes{"poses.tum", bytes_of(tum.str())}})
                          .and_then([](const Recording& recording) { return build_map(recording, kCoarse); });
  ASSERT_TRUE(mapped) << mapped.error().message;
  EXPECT_FALSE(mapped->path.nav);
  EXPECT_EQ(mapped->report.no_pose.count, 0U);
  EXPECT_TRUE(mapped->path.steps.empty());
}

TEST(Recording, SaysThatNothingCouldBeMapped) {
  const Dive dive = harbour_dive();
  const FileBytes elsewhen{"poses.tum", bytes_of("1000 0 0 0 0 0 0 1\n1001 0 0 0 0 0 0 1\n")};
  const auto mapped = Recording::open({dive.log}, {.poses = elsewhen}).and_then([](const Recording& recording) {
    return build_map(recording, kCoarse);
  });
  ASSERT_FALSE(mapped);
  EXPECT_EQ(mapped.error().code, Error::Code::kCorrupt);
  EXPECT_THAT(mapped.error().message, AllOf(HasSubstr("dive.csv"), HasSubstr("outside the time of the poses")));
}

}  // namespace
}  // namespace pingvox::test
