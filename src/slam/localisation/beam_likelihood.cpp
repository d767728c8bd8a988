#include "slam/localisation/beam_likelihood.hpp"

#include <algorithm>

namespace pingvox {
namespace {

/// Of an echo that came from the nearest occupied column at some distance.
double deviation_m(const HeardBeam& beam, const DistanceField& field, const BeamLikelihood& model) {
  // The wall may be anywhere in its column.
  return std::hypot(model.range_deviation_m, 0.3 * field.cell_m(), model.bearing_deviation_rad * beam.range_m);
}

}  // namespace

HeardBeam transform(const PlaneFrame& to_from, const HeardBeam& beam) {
  return {beam.time_s, to_from * beam.sonar_m, to_from.turn(beam.direction), beam.range_m, beam.has_echo};
}

EndTable::EndTable(const HeardBeam& beam, const DistanceField& field, const BeamLikelihood& model,
                   double more_deviation_m) {
  if (!beam.has_echo) return;
  const double deviation = std::hypot(deviation_m(beam, field, model), more_deviation_m);
  for (std::size_t value = 0; value < log_.size(); ++value) {
    const double far =
        static_cast<double>(value & DistanceField::kFar) / DistanceField::kFar * field.truncation_m() / deviation;
    const double other = (value & DistanceField::kUnknown) != 0 ? model.unknown : model.stray;
    log_[value] = static_cast<float>(std::log(other + (1.0 - other) * std::exp(-0.5 * far * far)));
  }
}

BeamJudge::BeamJudge(const HeardBeam& beam, const DistanceField& field, const BeamLikelihood& model)
    : field_(field),
      beam_(beam),
      end_m_(beam.end_m()),
      table_(beam, field, model),
      clear_m_(beam.range_m - 3.0 * deviation_m(beam, field, model) - 2.0 * field.cell_m()),
      log_behind_(std::log(model.behind)),
      log_silent_wall_(std::log(model.silent_wall)) {}

double BeamJudge::log_likelihood(const PlaneFrame& map_from_frame) const {
  const Eigen::Vector2d from = map_from_frame * beam_.sonar_m, direction = map_from_frame.turn(beam_.direction);
  if (!beam_.has_echo) {
    return field_.clear_range_m(from, direction, beam_.range_m) < beam_.range_m ? log_silent_wall_ : 0.0;
  }
  const Eigen::Vector2d end = map_from_frame * end_m_;
  const double at_end = table_[field_.value_at(end.x(), end.y())];
  if (at_end <= log_behind_ || field_.clear_range_m(from, direction, clear_m_) >= clear_m_) return at_end;
  return log_behind_;
}

double log_likelihood(std::span<const BeamJudge> judges, const Pose2& map_from_frame, const BeamLikelihood& model) {
  const PlaneFrame frame(map_from_frame);
  double sum = 0.0;
  for (const BeamJudge& judge : judges) sum += judge.log_likelihood(frame);
  return model.beam_weight * sum;
}

std::optional<double> fit_of(std::span<const HeardBeam> beams, const DistanceField& field, const BeamLikelihood& model,
                             const Pose2& map_from_frame) {
  const PlaneFrame frame(map_from_frame);
  double sum = 0.0;
  std::size_t echoes = 0;
  for (const HeardBeam& beam : beams) {
    if (!beam.has_echo) continue;
    ++echoes;
    sum += std::exp(BeamJudge(beam, field, model).log_likelihood(frame));
  }
  if (echoes < 10) return std::nullopt;
  return sum / static_cast<double>(echoes);
}

void add_end_likelihood(const DistanceField& field, const EndTable& table, const Eigen::Vector2d& end_m,
                        std::span<const double> x_m, std::span<const double> y_m, std::span<const double> cosine,
                        std::span<const double> sine, std::span<float> sums) {
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const double x = x_m[i] + cosine[i] * end_m.x() - sine[i] * end_m.y();
    const double y = y_m[i] + sine[i] * end_m.x() + cosine[i] * end_m.y();
    sums[i] += table[field.value_at(x, y)];
  }
}

}  // namespace pingvox
