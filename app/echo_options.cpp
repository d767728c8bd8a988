#include "echo_options.hpp"

#include <fmt/format.h>

#include <array>
#include <string_view>

#include "input_kinds.hpp"
#include "mapping/internal/option_limits.hpp"
#include "option_values.hpp"
#include "sonar/internal/option_limits.hpp"

namespace pingvox::app {
namespace {

constexpr std::array kFilters = {Choice<Filter>{"none", Filter::kNone}, Choice<Filter>{"mean", Filter::kMean},
                                 Choice<Filter>{"median", Filter::kMedian},
                                 Choice<Filter>{"gaussian", Filter::kGaussian}};
constexpr std::array kDetectors = {Choice<Detector>{"rise", Detector::kRise},
                                   Choice<Detector>{"level", Detector::kLevel}, Choice<Detector>{"max", Detector::kMax},
                                   Choice<Detector>{"canny", Detector::kCanny},
                                   Choice<Detector>{"cfar", Detector::kCfar}};
constexpr std::array kCfars = {Choice<CfarOptions::Noise>{"ca", CfarOptions::Noise::kCellAveraging},
                               Choice<CfarOptions::Noise>{"so", CfarOptions::Noise::kSmallestOf},
                               Choice<CfarOptions::Noise>{"go", CfarOptions::Noise::kGreatestOf},
                               Choice<CfarOptions::Noise>{"os", CfarOptions::Noise::kOrdered}};

/// "T,S", "T,S,D" or "nav,S".
Take store_water(EchoArgs& args, WaterOfNav of_nav) {
  return [&args, of_nav](const std::string& text) -> Result<void> {
    constexpr std::string_view kOfNav = "nav,";
    std::array<double, 3> n{};
    args.water.reset();
    args.nav_salinity.reset();
    if (text.starts_with(kOfNav)) {
      const auto salinity = numbers_from<1>(text.substr(kOfNav.size()));
      if (!salinity) return tl::unexpected(salinity.error());
      if (const auto valid = Water{.salinity = (*salinity)[0]}.validate(); !valid) return tl::unexpected(valid.error());
      args.nav_salinity = (*salinity)[0];
      return {};
    }
    const auto three = numbers_from<3>(text);
    const auto two = numbers_from<2>(text);
    if (three) n = *three;
    if (two) n = {(*two)[0], (*two)[1], 0.0};
    if (!two && !three) {
      return usage_error(
          fmt::format("'{}': must be temperature and salinity, and the depth if it matters: T,S or T,S,D{}", text,
                      of_nav == WaterOfNav::kYes ? "; or nav,S" : ""));
    }
    const Water given{.temperature_c = n[0], .salinity = n[1], .depth_m = n[2]};
    if (const auto valid = given.validate(); !valid) return tl::unexpected(valid.error());
    args.water = given;
    return {};
  };
}

/// A number, or 'auto' for none.
template <class Number>
Take store_or_auto(std::optional<Number>& target) {
  return [&target](const std::string& text) -> Result<void> {
    if (text != "auto") return store_optional(target)(text);
    target.reset();
    return {};
  };
}

Take store_kernel(std::optional<int>& target) {
  const Take take = within(kFilterKernels, store_optional(target));
  return [&target, take](const std::string& text) -> Result<void> {
    if (auto taken = take(text); !taken) return taken;
    if (*target % 2 == 0) return usage_error(fmt::format("must be odd, is {}", text));
    return {};
  };
}

}  // namespace

double EchoArgs::sound_speed_ratio() const {
  if (water) return ::pingvox::sound_speed_ratio(*water);
  return sound_speed_m_s.value_or(kAssumedSoundSpeed_m_s) / kAssumedSoundSpeed_m_s;
}

Result<void> EchoArgs::validate(const std::vector<std::string>& navs) const {
  if ((water || nav_salinity) && sound_speed_m_s) return usage_error("--sound-speed and --water: exclude each other");
  if (nav_salinity && navs.empty()) {
    return usage_error("--water nav,S: needs a navigation log (--nav of 'map', 'render', 'slam' and 'locate')");
  }
  return {};
}

OptionTable::Group echo_group(EchoArgs& args, WaterOfNav water) {
  EchoOptions& echo = args.echo;
  const std::vector<std::string> beams = {std::string(kBeamLogs)};
  OptionTable::Group group = {
      "Echoes",
      {{"--min-range", 0, "M|auto", "ignore echoes nearer than M (transducer ringing); auto: measured per sweep",
        number_text(EchoOptions::kDefaultBlanking_m), within(kNearestRanges_m, store_or_auto(echo.min_range_m))},
       number("--min-bin", "N", "ignore bins before bin N (the first is 0)", echo.min_bin),
       {"--max-range", 0, "M",
        "ignore echoes and cells farther than M; a beam whose only echoes are farther marks cells up to M free", "none",
        within(kFarthestRanges_m, store_number(echo.max_range_m))},
       {"--sound-speed", 0, "M/S", "speed of sound in this water; devices assume 1500 m/s",
        number_text(kAssumedSoundSpeed_m_s),
        within(in_units_of(1.0 / kAssumedSoundSpeed_m_s, kSoundSpeedRatios), store_optional(args.sound_speed_m_s))},
       {"--water", 0, water == WaterOfNav::kYes ? "T,S[,D]|nav,S" : "T,S[,D]",
        std::string("speed of sound from temperature in degrees C, salinity (0 fresh, 35 ocean) and depth in m") +
            (water == WaterOfNav::kYes ? "; nav: temperature and depth from --nav" : ""),
        "none", store_water(args, water)},
       choice("--filter", kFilters,
              "smoothing of sweeps before echoes are detected; without it fewer beams have an echo", args.filter),
       {"--kernel", 0, "N", "size of the filter's window in beams and bins, odd", "5, canny: 11",
        store_kernel(args.kernel)},
       {"--sigma", 0, "SIGMA", "standard deviation of the Gaussian in beams and bins", "1, canny: 2.3",
        within(kFilterSigmas, store_optional(args.sigma))},
       choice("--detect", kDetectors,
              "echo detector: the first rise, the first bin above a level, the strongest bin, the first edge in the "
              "image (canny), or the first bin above the noise around it (cfar)",
              echo.detector),
       {"--threshold", 0, "T|auto", "lowest rise, level or gradient (canny) of the intensity that is an echo",
        "automatic, from the contrast of nearby beams", store_or_auto(echo.threshold)},
       choice("--cfar", kCfars, "noise estimate of cfar: cell-averaging, smallest-of, greatest-of or ordered-statistic",
              echo.cfar.noise),
       {"--background", 0, "M",
        "subtract what is the same in all sweeps up to M: echoes of the vehicle itself, and all others if it stands "
        "still; reads the logs twice",
        "off", within(kBackgroundRanges_m, store_optional(args.background_m))}}};
  for (Option& option : group.options) {
    if (option.name != "--max-range") option.only_for = beams;
    if (option.name == "--kernel") option.only_with = {{"--filter", {"mean", "median", "gaussian"}}};
    if (option.name == "--sigma") option.only_with = {{"--filter", {"gaussian"}}};
    if (option.name == "--cfar") option.only_with = {{"--detect", {"cfar"}}};
  }
  return group;
}

}  // namespace pingvox::app
