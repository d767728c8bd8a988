#include "io/internal/a50_nav.hpp"

#include <fmt/format.h>

#include "io/nav/dvl_a50.hpp"
#include "io/nav/nav_sources.hpp"
#include "pingvox/nav/device_clock.hpp"

namespace pingvox {

struct A50Nav::State {
  /// Time at which a report was measured: that of a velocity contains its delay, that of a position is the device's.
  double time_of(const A50Report& report, double received_s) {
    if (report.kind != A50Report::Kind::kPosition || !report.made_s) return received_s - report.latency_s;
    return clock.add({received_s, *report.made_s});
  }

  DeviceClock clock;  ///< of positions
};

A50Nav::A50Nav() : state_(std::make_unique<State>()) {}
A50Nav::A50Nav(A50Nav&&) noexcept = default;
A50Nav& A50Nav::operator=(A50Nav&&) noexcept = default;
A50Nav::~A50Nav() = default;

std::optional<std::vector<NavSource>> A50Nav::add(std::string_view line, double received_s) {
  const auto members = json_members(line);
  if (!members) return std::nullopt;
  const A50Reading report = a50_report(*members);
  if (!report) return std::nullopt;
  NavSources sources;
  if (report->kind != A50Report::Kind::kOther) {
    add_a50_report(sources, "A50", state_->time_of(*report, received_s), *report);
  }
  return sources.take();
}

std::string with_timestamp(std::string_view line, double received_s) {
  const auto members = json_members(line);
  if (!members || members->empty()) return std::string(line);
  const std::size_t brace = line.find('{');
  return fmt::format(R"({{"timestamp":{:.6f},{})", received_s, line.substr(brace + 1));
}

}  // namespace pingvox
