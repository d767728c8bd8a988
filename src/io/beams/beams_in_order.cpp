#include "io/internal/beams_in_order.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <deque>
#include <optional>
#include <utility>

#include "pingvox/nav/time_order.hpp"
#include "sonar/internal/beam_source_decorator.hpp"

namespace pingvox {
namespace {

class BeamsInOrder final : public BeamSourceDecorator {
 public:
  BeamsInOrder(std::unique_ptr<BeamSource> source, std::string name)
      : BeamSourceDecorator(std::move(source)), name_(std::move(name)) {}

  Result<std::optional<Beam>> next() override {
    while (!is_at_end_ && (held_.empty() || held_.back().time_s - held_.front().time_s <= kMaxSwapped_s)) {
      Result<std::optional<Beam>> beam = source().next();
      if (!beam) return beam;
      if (*beam) {
        order_.add((*beam)->time_s);
        const auto place = std::ranges::upper_bound(held_, (*beam)->time_s, {}, &Beam::time_s);
        held_.insert(place, *std::move(*beam));
      } else {
        is_at_end_ = true;
      }
    }
    if (held_.empty()) return end();
    Beam beam = std::move(held_.front());
    held_.pop_front();
    return beam;
  }

 private:
  Result<std::optional<Beam>> end() const {
    const std::optional<ClockStep> step = order_.step_back();
    if (!step) return std::nullopt;
    return fail(
        Error::Code::kCorrupt,
        fmt::format("{}: its clock runs back by {:.3f} s, from {:.3f} to {:.3f} s: which of its times are right "
                    "is ambiguous: cut the log there",
                    name_, step->from_s - step->to_s, step->from_s, step->to_s));
  }

  std::string name_;
  std::deque<Beam> held_;
  TimeOrder order_;
  bool is_at_end_ = false;
};

}  // namespace

std::unique_ptr<BeamSource> in_order(std::unique_ptr<BeamSource> source, std::string name) {
  return std::make_unique<BeamsInOrder>(std::move(source), std::move(name));
}

}  // namespace pingvox
