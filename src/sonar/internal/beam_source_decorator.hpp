#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// A source that changes the beams of another: what was skipped, the head, the clock, the note and the share
/// that was read are the other's.
class BeamSourceDecorator : public BeamSource {
 public:
  std::size_t skipped() const override { return source_->skipped(); }
  std::vector<DamageKind> damage() const override { return source_->damage(); }
  std::string first_damage() const override { return source_->first_damage(); }
  const DeviceProfile* device() const override { return source_->device(); }
  BeamClock clock() const override { return source_->clock(); }
  std::string note() const override { return source_->note(); }
  std::optional<double> share_read() const override { return source_->share_read(); }

 protected:
  explicit BeamSourceDecorator(std::unique_ptr<BeamSource> source) : source_(std::move(source)) {}
  BeamSource& source() { return *source_; }

 private:
  std::unique_ptr<BeamSource> source_;
};

}  // namespace pingvox
