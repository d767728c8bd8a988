#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pingvox {

enum class AngleUnit { kRadian, kDegree, kGradian };  ///< 2 pi, 360 and 400 a turn

double radians_of(AngleUnit unit);
/// "radians"
std::string_view name_of(AngleUnit unit);

/// Finds the unit of the angles of a turning head from many of them: by how far they reach and where they wrap.
class AngleUnits {
 public:
  /// More angles are not needed: some turns of any head.
  static constexpr std::size_t kMaxAngles = 1000;

  /// @param stated  by the definition of the messages, or the name of the column
  explicit AngleUnits(AngleUnit stated) : stated_(stated) {}

  /// The next angle, as it is in the log.
  void add(double angle) { angles_.push_back(angle); }
  /// Whether more angles would change nothing.
  bool are_enough() const;
  /// The unit of those so far: the stated one where nothing speaks against it. nullopt: they are not in that unit, and
  /// in which is not known.
  std::optional<AngleUnit> unit() const;
  /// Whether the angles go on from turn to turn.
  bool count_turns() const;
  /// "holds gradians, it seems: its numbers go from 0 to 399"; empty: they are in the stated unit.
  std::string problem_text() const;
  /// "from 0 to 399". REQUIRES an angle.
  std::string range_text() const;

 private:
  struct Shape;
  Shape shape() const;

  AngleUnit stated_;
  std::vector<double> angles_;
};

}  // namespace pingvox
