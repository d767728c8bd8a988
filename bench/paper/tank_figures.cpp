#include "tank_figures.hpp"

#include <fmt/core.h>

#include <array>
#include <optional>
#include <utility>

#include "pingvox/viewer/render_cartesian.hpp"
#include "pingvox/viewer/render_echoes.hpp"
#include "pingvox/viewer/render_map.hpp"
#include "pingvox/viewer/side_by_side.hpp"

namespace pingvox::bench {
namespace {

using Echoes = std::vector<std::optional<Echo>>;

constexpr std::size_t kTankPanel_px = 320;

Picture cartesian(const Sweep& sweep, const PolarImage& image, const Echoes& echoes,
                  BetweenBeams between = BetweenBeams::kInterpolate) {
  CartesianPictureOptions options;
  options.style.target_px = 260;  // noise makes large files
  options.between = between;
  return render_cartesian(sweep, image, echoes, options);
}

/// The sweep with the intensities of an image.
std::vector<Beam> beams_of(const Sweep& sweep, const PolarImage& image) {
  std::vector<Beam> beams = sweep.beams;
  for (std::size_t n = 0; n < beams.size(); ++n) {
    const auto row = image.row(n).first(beams[n].intensities.size());
    beams[n].intensities.assign(row.begin(), row.end());
  }
  return beams;
}

Picture polar(const std::vector<Beam>& beams) {
  return render_echoes(beams, {}, {.target_px = 320});
}

/// A map as in the paper: the axes of one sweep's beams, each up to its echo.
Result<Picture> map_picture(const Sweep& sweep, const FilterOptions& filter, const EchoOptions& echo) {
  OccupancyMap map;
  BeamsInMemory beams(sweep.beams);
  const BuildOptions options{.filter = filter, .echo = echo, .model = {.shape = BeamShape::kRay}};
  const auto report = build_map(beams, Trajectory::still(Pose::Identity()), options, map);
  if (!report) return tl::unexpected(report.error());
  // All maps to the same scale.
  const Box tank{{-2.9, -2.3, 0.0}, {2.7, 3.1, 0.0}};
  return render_map(map, {.target_px = kTankPanel_px, .at_least = tank});
}

/// Collects pictures as panels of one figure, or the first error.
class Figures {
 public:
  void add(std::string name, std::string section, std::string says, const std::vector<Panel>& panels) {
    if (error_) return;
    Result<Picture> joined = side_by_side(panels);
    if (!joined) {
      error_ = joined.error();
      return;
    }
    figures_.push_back({std::move(name), std::move(section), std::move(says), std::move(*joined)});
  }

  void add_map(std::vector<Panel>& panels, const Sweep& sweep, const FilterOptions& filter, const EchoOptions& echo,
               std::string caption) {
    Result<Picture> picture = map_picture(sweep, filter, echo);
    if (!picture) {
      error_ = picture.error();
      return;
    }
    panels.push_back({std::move(*picture), std::move(caption)});
  }

  Result<std::vector<TankFigure>> all() && {
    if (error_) return tl::unexpected(*error_);
    return std::move(figures_);
  }

 private:
  std::vector<TankFigure> figures_;
  std::optional<Error> error_;
};

}  // namespace

Result<std::vector<TankFigure>> tank_figures(const TankLog& log) {
  if (log.sweeps.size() < 2) return fail(Error::Code::kCorrupt, log.name + ": has no second sweep");
  const Sweep& sweep = log.sweeps[1];
  const PolarImage raw(sweep), smooth = apply_filter(raw, {});
  Figures figures;
  figures.add("figure-2-4", "2.1", "a sweep in Cartesian coordinates, without and with interpolation",
              {{cartesian(sweep, raw, {}, BetweenBeams::kNothing), "2: without interpolation"},
               {cartesian(sweep, raw, {}), "4: with interpolation"}});
  figures.add("figure-3", "2.1", "the same sweep in polar coordinates", {{polar(sweep.beams), "3: as it was heard"}});

  std::vector<Panel> smoothing;
  figures.add_map(smoothing, sweep, {.filter = Filter::kNone}, {.threshold = 70}, "13: without smoothing");
  figures.add_map(smoothing, sweep, {}, {.threshold = 70}, "14: with Gaussian smoothing");
  figures.add("figure-13-14", "8.1", "false positives without smoothing, clearly better with it", smoothing);

  std::vector<Panel> filters = {{cartesian(sweep, raw, {}), "15: as it was heard"}};
  for (const auto& [filter, name] : {std::pair{Filter::kMean, "mean"}, std::pair{Filter::kMedian, "median"},
                                     std::pair{Filter::kGaussian, "Gaussian"}}) {
    const FilterOptions options{.filter = filter, .kernel = 5, .sigma = 1.0};
    filters.push_back({cartesian(sweep, apply_filter(raw, options), {}), fmt::format("15: {} of 5 by 5", name)});
  }
  figures.add("figure-15", "8.1", "mean suffers from outliers; median and Gaussian satisfy", filters);
  figures.add("figure-16", "8.1", "a stripe at the left: the vehicle's own reflections",
              {{polar(beams_of(sweep, smooth)), "16: Gaussian in polar coordinates"}});

  std::vector<Panel> thresholds;
  for (const auto& [figure, threshold] :
       {std::pair{17, 20}, std::pair{18, 40}, std::pair{19, 70}, std::pair{20, 140}}) {
    figures.add_map(thresholds, sweep, {}, {.threshold = threshold},
                    fmt::format("{}: threshold {}", figure, threshold));
  }
  figures.add("figure-17-20", "8.2", "70 is best: low enough for all obstacles, high enough for noise", thresholds);

  const EchoOptions canny{.detector = Detector::kCanny, .threshold = 113};
  const PolarImage smoother = apply_filter(raw, default_filter(Detector::kCanny));
  const EchoOptions rise{.threshold = 70};
  figures.add("figure-21", "9", "Canny reduces noise; to be explored",
              {{cartesian(sweep, smoother, detect_echoes(smoother, sweep, canny)), "21: first edges by Canny"},
               {cartesian(sweep, smooth, detect_echoes(smooth, sweep, rise)), "beside it: rises of 70"}});
  return std::move(figures).all();
}

}  // namespace pingvox::bench
