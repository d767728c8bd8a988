#include "pingvox/sonar/sweep.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <numbers>
#include <ostream>
#include <random>
#include <vector>

namespace pingvox {
namespace {

using Extent = Sweep::Extent;
using testing::Each;
using testing::ElementsAre;
using testing::IsEmpty;

Beam beam_at(double degrees, std::size_t bins = 3, double bin_length_m = 0.0125) {
  return {.time_s = 0.0,
          .bearing_rad = wrap_bearing(degrees * std::numbers::pi / 180.0),
          .bin_length_m = bin_length_m,
          .intensities = std::vector<std::uint8_t>(bins)};
}

struct Cut {
  Extent extent;
  std::size_t beams;
  friend bool operator==(const Cut&, const Cut&) = default;
  friend std::ostream& operator<<(std::ostream& out, const Cut& cut) {
    constexpr std::array<const char*, 3> kNames = {"turn", "sector", "cut"};
    return out << kNames.at(static_cast<std::size_t>(cut.extent)) << " of " << cut.beams;
  }
};

std::vector<Cut> cuts_of(const std::vector<Beam>& beams) {
  std::vector<Cut> cuts;
  for (const Sweep& sweep : sweeps_of(beams)) cuts.push_back({sweep.extent, sweep.beams.size()});
  return cuts;
}

std::vector<Cut> cuts_of_bearings(const std::vector<double>& degrees) {
  std::vector<Beam> beams;
  beams.reserve(degrees.size());
  for (const double d : degrees) beams.push_back(beam_at(d));
  return cuts_of(beams);
}

/// `count` bearings from `start`, `step` apart.
std::vector<double> run(double start, double step, int count) {
  std::vector<double> degrees;
  degrees.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) degrees.push_back(start + step * i);
  return degrees;
}

std::vector<double> operator+(std::vector<double> a, const std::vector<double>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST(SweepAssembler, CutsTurnsWhereTheyBeganAndNotWhereTheBearingWraps) {
  EXPECT_THAT(cuts_of_bearings(run(180.0, 1.8, 604)), ElementsAre(Cut{Extent::kTurn, 200}, Cut{Extent::kTurn, 200},
                                                                  Cut{Extent::kTurn, 200}, Cut{Extent::kCut, 4}));
}

TEST(SweepAssembler, CutsTurnsTheOtherWayRound) {
  EXPECT_THAT(cuts_of_bearings(run(90.0, -1.8, 403)),
              ElementsAre(Cut{Extent::kTurn, 200}, Cut{Extent::kTurn, 200}, Cut{Extent::kCut, 3}));
}

TEST(SweepAssembler, EndsATurnInTimeWhenBearingsAreInSinglePrecision) {
  for (const double step : {1.8, 0.9, 0.45, 0.225, 0.05625, -1.8, -0.9, 3.6, 7.2}) {
    SCOPED_TRACE(step);
    const int beams = static_cast<int>(std::lround(360.0 / std::abs(step)));
    for (const double start : {0.0, 180.0, 0.7, 359.1}) {
      SCOPED_TRACE(start);
      std::vector<double> degrees;
      for (int i = 0; i < 3 * beams; ++i) {
        const auto rounded = static_cast<float>(start + step * (i % beams));
        degrees.push_back(std::fmod(static_cast<double>(rounded) + 720.0, 360.0));
      }
      const Cut turn{Extent::kTurn, static_cast<std::size_t>(beams)};
      EXPECT_THAT(cuts_of_bearings(degrees), ElementsAre(turn, turn, turn));
    }
  }
}

TEST(SweepAssembler, CountsATurnWhoseStepDoesNotDivideTheCircle) {
  // 7 degrees: beam 51 is at 357 degrees, beam 52 at 364.
  EXPECT_THAT(cuts_of_bearings(run(0.0, 7.0, 104)), ElementsAre(Cut{Extent::kTurn, 52}, Cut{Extent::kTurn, 52}));
}

TEST(SweepAssembler, KnowsThatTheLastTurnOfARecordingIsCompleteWithoutTheBeamBehindIt) {
  EXPECT_THAT(cuts_of_bearings(run(0.0, 1.8, 200)), ElementsAre(Cut{Extent::kTurn, 200}));
  EXPECT_THAT(cuts_of_bearings(run(0.0, 1.8, 199)), ElementsAre(Cut{Extent::kCut, 199}));
}

TEST(SweepAssembler, CutsASectorWhereTheHeadTurnsBack) {
  std::vector<double> degrees;
  for (int pass = 0; pass < 2; ++pass) degrees = degrees + run(330.0, 1.8, 30) + run(330.0 + 1.8 * 28, -1.8, 28);
  EXPECT_THAT(cuts_of_bearings(degrees), ElementsAre(Cut{Extent::kSector, 30}, Cut{Extent::kSector, 29},
                                                     Cut{Extent::kSector, 29}, Cut{Extent::kCut, 28}));
}

TEST(SweepAssembler, KeepsTheEndOfASectorThatIsHeardTwiceInOneSweep) {
  EXPECT_THAT(cuts_of_bearings(run(10.0, 1.8, 20) + run(10.0 + 1.8 * 19, -1.8, 20)),
              ElementsAre(Cut{Extent::kSector, 21}, Cut{Extent::kCut, 19}));
}

TEST(SweepAssembler, TellsASectorOfNearlyACircleFromATurn) {
  const auto there = run(0.0, 1.8, 190);
  const auto back = run(1.8 * 188, -1.8, 189);
  EXPECT_THAT(cuts_of_bearings(there + back), ElementsAre(Cut{Extent::kSector, 190}, Cut{Extent::kCut, 189}));
}

TEST(SweepAssembler, CutsWhereAHeadFliesBackToTheBeginningOfItsSector) {
  for (const double width_deg : {90.0, 270.0}) {
    SCOPED_TRACE(width_deg);
    const auto pass = run(45.0, 1.8, static_cast<int>(width_deg / 1.8));
    EXPECT_THAT(cuts_of_bearings(pass + pass + pass),
                ElementsAre(Cut{Extent::kSector, pass.size()}, Cut{Extent::kSector, pass.size()},
                            Cut{Extent::kCut, pass.size()}));
  }
}

TEST(SweepAssembler, DoesNotTakeJitterForTurningBack) {
  auto degrees = run(0.0, 1.8, 200);
  for (std::size_t i = 0; i < degrees.size(); ++i) degrees[i] += i % 2 == 0 ? 0.0 : -2.2;  // each second goes back 0.4
  EXPECT_THAT(cuts_of_bearings(degrees), ElementsAre(Cut{Extent::kTurn, 200}));
}

TEST(SweepAssembler, DoesNotLetJitterOfTheFirstBeamsDecideTheDirection) {
  EXPECT_THAT(cuts_of_bearings(std::vector{100.0, 100.01} + run(98.2, -1.8, 199)),
              ElementsAre(Cut{Extent::kTurn, 201}));
}

TEST(SweepAssembler, CutsWhereASectorTurnsBackAlsoWhenBeamsWereLostThere) {
  const auto there = run(0.0, 1.8, 20);
  auto with_gap = there;
  with_gap.erase(with_gap.begin() + 17, with_gap.begin() + 19);
  EXPECT_THAT(cuts_of_bearings(with_gap + run(1.8 * 18, -1.8, 19)),
              ElementsAre(Cut{Extent::kSector, 18}, Cut{Extent::kCut, 19}));
  EXPECT_THAT(cuts_of_bearings(there + run(1.8 * 14, -1.8, 15)),
              ElementsAre(Cut{Extent::kSector, 20}, Cut{Extent::kCut, 15}));
}

TEST(SweepAssembler, KeepsDoubledBeams) {
  std::vector<double> degrees;
  for (int i = 0; i < 400; ++i) degrees.insert(degrees.end(), 2, 1.8 * i);
  EXPECT_THAT(cuts_of_bearings(degrees), ElementsAre(Cut{Extent::kTurn, 400}, Cut{Extent::kTurn, 400}));
}

TEST(SweepAssembler, BridgesLostBeamsAlsoAtTheSeam) {
  auto degrees = run(0.0, 1.8, 600);
  degrees.erase(degrees.begin() + 395, degrees.begin() + 405);  // the seam of the second and third turn
  degrees.erase(degrees.begin() + 198, degrees.begin() + 200);  // the last two of the first
  degrees.erase(degrees.begin() + 50, degrees.begin() + 60);
  // The third turn begins five steps late and so is not over yet at the end of the recording.
  EXPECT_THAT(cuts_of_bearings(degrees),
              ElementsAre(Cut{Extent::kTurn, 188}, Cut{Extent::kTurn, 195}, Cut{Extent::kCut, 195}));
}

TEST(SweepAssembler, DoesNotEndATurnEarlyWhenALostBeamMakesTheLastStepLarge) {
  auto degrees = run(0.0, 1.8, 400);
  degrees.erase(degrees.begin() + 198);  // 354.6, then 358.2: half of this step short of a turn
  EXPECT_THAT(cuts_of_bearings(degrees), ElementsAre(Cut{Extent::kTurn, 199}, Cut{Extent::kTurn, 200}));
}

TEST(SweepAssembler, CutsAtAWideGap) {
  // 100 degrees lost in the middle of a turn; the head goes on and needs a whole turn more from there.
  EXPECT_THAT(cuts_of_bearings(run(0.0, 1.8, 50) + run(188.2, 1.8, 200)),
              ElementsAre(Cut{Extent::kCut, 50}, Cut{Extent::kTurn, 200}));
  // A new sector on the other side.
  EXPECT_THAT(cuts_of_bearings(run(0.0, 1.8, 20) + run(180.0, 1.8, 20) + run(180.0 + 1.8 * 18, -1.8, 10)),
              ElementsAre(Cut{Extent::kCut, 20}, Cut{Extent::kSector, 20}, Cut{Extent::kCut, 10}));
}

TEST(SweepAssembler, FollowsAHeadWhoseStepIsWiderThanAnyGap) {
  EXPECT_THAT(cuts_of_bearings(run(0.0, 90.0, 12)),
              ElementsAre(Cut{Extent::kTurn, 4}, Cut{Extent::kTurn, 4}, Cut{Extent::kTurn, 4}));
}

TEST(SweepAssembler, GoesOnWhenTheStepChanges) {
  // Half a turn in coarse steps, half in fine ones, then coarse again.
  EXPECT_THAT(cuts_of_bearings(run(0.0, 1.8, 100) + run(180.0, 0.45, 400) + run(0.0, 3.6, 100)),
              ElementsAre(Cut{Extent::kTurn, 500}, Cut{Extent::kTurn, 100}));
}

TEST(SweepAssembler, KeepsBeamsOfDifferentLengthsTogether) {
  std::vector<Beam> beams;
  beams.reserve(300);
  for (int i = 0; i < 200; ++i) beams.push_back(beam_at(1.8 * i, i == 70 ? 0 : i == 100 ? 186 : 399));
  EXPECT_THAT(cuts_of(beams), ElementsAre(Cut{Extent::kTurn, 200}));
}

TEST(SweepAssembler, CutsWhenTheBinLengthChangesButNotForItsRounding) {
  std::vector<Beam> beams;
  beams.reserve(300);
  for (int i = 0; i < 100; ++i) beams.push_back(beam_at(1.8 * i, 3, i % 2 == 0 ? 8.0 / 397 : 8.0 / 398));
  for (int i = 100; i < 300; ++i) beams.push_back(beam_at(1.8 * i, 3, 0.025));
  EXPECT_THAT(cuts_of(beams), ElementsAre(Cut{Extent::kCut, 100}, Cut{Extent::kTurn, 200}));
}

// Kills a small change of the range within a sweep, whose bins would not be of one range in the image.
TEST(SweepAssembler, CutsWhereTheBinLengthChangesByMoreThanAHundredth) {
  for (const double change : {-0.3, -0.02, -0.005, 0.005, 0.02, 0.3}) {
    SCOPED_TRACE(change);
    std::vector<Beam> beams;
    for (int i = 0; i < 200; ++i) beams.push_back(beam_at(1.8 * i, 3, i < 100 ? 0.02 : 0.02 * (1.0 + change)));
    if (std::abs(change) < 0.01) {
      EXPECT_THAT(cuts_of(beams), ElementsAre(Cut{Extent::kTurn, 200}));
    } else {
      EXPECT_THAT(cuts_of(beams), ElementsAre(Cut{Extent::kCut, 100}, Cut{Extent::kCut, 100}));
    }
  }
}

// Kills a turn that ends early since beams were lost some steps before.
TEST(SweepAssembler, DoesNotEndATurnEarlyAfterAGapNearItsEnd) {
  for (int gap = 2; gap < 44; ++gap) {
    SCOPED_TRACE(gap);
    // The gap ends nine steps before the turn does.
    const std::vector<double> degrees = run(0.0, 1.0, 352 - gap) + run(351.0, 1.0, 9) + run(0.0, 1.0, 10);
    EXPECT_THAT(cuts_of_bearings(degrees),
                ElementsAre(Cut{Extent::kTurn, static_cast<std::size_t>(361 - gap)}, Cut{Extent::kCut, 10}));
  }
}

TEST(SweepAssembler, CutsAHeadThatStandsStill) {
  EXPECT_THAT(cuts_of_bearings(std::vector(SweepAssembler::kMaxBeams + 5, 12.0)),
              ElementsAre(Cut{Extent::kCut, SweepAssembler::kMaxBeams}, Cut{Extent::kCut, 5}));
}

TEST(SweepAssembler, DoesNotLetOneLongBeamMakeAnImageOutOfProportion) {
  std::vector<Beam> beams;
  beams.push_back(beam_at(0.0, SweepAssembler::kMaxPixels / 4, 1e-5));
  for (int i = 1; i < 100; ++i) beams.push_back(beam_at(i, 1, 1e-5));
  EXPECT_THAT(cuts_of(beams), ElementsAre(Cut{Extent::kCut, 4}, Cut{Extent::kCut, 96}));
  EXPECT_THAT(cuts_of({beam_at(0.0, SweepAssembler::kMaxPixels + 1, 1e-5), beam_at(1.0)}),
              ElementsAre(Cut{Extent::kCut, 1}, Cut{Extent::kCut, 1}));
}

TEST(SweepAssembler, FinishOfNothingIsNothingAndItStartsAnew) {
  SweepAssembler assembler;
  EXPECT_FALSE(assembler.finish());
  EXPECT_FALSE(assembler.add(beam_at(5.0)));
  EXPECT_TRUE(assembler.finish());
  EXPECT_FALSE(assembler.finish());
  EXPECT_FALSE(assembler.add(beam_at(185.0))) << "the beam before finish() must be forgotten";
}

TEST(SweepAssembler, LosesAndReordersNoBeamWhateverTheHeadDoes) {
  std::size_t checked = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    SweepAssembler assembler;
    std::vector<double> times;
    const auto take = [&times](const std::optional<Sweep>& sweep) {
      if (!sweep) return;
      EXPECT_FALSE(sweep->beams.empty());
      EXPECT_LE(sweep->beams.size(), SweepAssembler::kMaxBeams);
      for (const Beam& beam : sweep->beams) times.push_back(beam.time_s);
    };
    double bearing = 0.0;
    double step = 1.8;
    for (int i = 0; i < 500; ++i) {
      switch (random() % 40) {
        case 0:
          step = -step;
          break;
        case 1:
          step = static_cast<double>(random() % 100) - 50.0;
          break;
        case 2:
          bearing += static_cast<double>(random() % 360);
          break;
        case 3:
          bearing -= step;
          break;
        default:
          break;
      }
      bearing += step;
      Beam beam = beam_at(bearing, random() % 5);
      beam.time_s = i;
      take(assembler.add(beam));
    }
    take(assembler.finish());
    ASSERT_EQ(times.size(), 500U);
    for (std::size_t i = 0; i < times.size(); ++i) EXPECT_EQ(times[i], static_cast<double>(i));
    checked += times.size();
  }
  EXPECT_EQ(checked, 100'000U);
}

}  // namespace
}  // namespace pingvox
