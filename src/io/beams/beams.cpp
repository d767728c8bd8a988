#include "pingvox/io/beams.hpp"

#include <fmt/core.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "base/without_exceptions.hpp"
#include "io/internal/frame_finder.hpp"
#include "io/readers.hpp"
#include "pingvox/io/format.hpp"
#include "sonar/internal/beam_source_decorator.hpp"

namespace pingvox {
namespace {

tl::unexpected<Error> wrong_format(const std::string& name, std::string_view wanted, std::optional<Format> format) {
  return fail(Error::Code::kUnsupported, format
                                             ? fmt::format("{}: is {}, not {}", name, description_of(*format), wanted)
                                             : fmt::format("{}: not {} that we know", name, wanted));
}

Result<std::unique_ptr<BeamSource>> open_bag_beams(ByteStream stream, Damage damage, const BeamTopic& topic) {
  const std::string name = stream.name();
  Result<BagLog> log = open_any_bag(std::move(stream), damage, topic);
  if (!log) return tl::unexpected(log.error());
  if (auto* beams = std::get_if<std::unique_ptr<BeamSource>>(&*log)) return std::move(*beams);
  return fail(Error::Code::kUnsupported, fmt::format("{}: holds scans of points, not beams of a sonar", name));
}

Result<std::unique_ptr<BeamSource>> open_any_beams(ByteStream stream, Damage damage, const BeamTopic& topic) {
  const std::optional<Format> streamed = streamed_format_of(stream.beginning());
  if (streamed && is_bag(*streamed)) return open_bag_beams(std::move(stream), damage, topic);
  if (streamed == Format::kPingViewer) return open_ping_viewer(std::move(stream), damage);
  if (streamed == Format::kPingText) return open_ping_text(std::move(stream), damage);
  if (streamed == Format::kSonarView) return open_sonarview(std::move(stream), damage);
  if (streamed == Format::kSeanetCapture) return open_seanet_capture(std::move(stream), damage);
  if (streamed == Format::kUdpCapture) return open_udp_capture(std::move(stream), damage);
  if (streamed == Format::kV4log) return open_v4log(std::move(stream), damage);
  if (streamed == Format::kDumplog) return open_dumplog(std::move(stream), damage);
  if (streamed == Format::kIctineuBeams) return open_ictineu_beams(std::move(stream), damage);
  Result<FileBytes> whole = ByteStream::whole(std::move(stream));
  if (!whole) return tl::unexpected(whole.error());
  FileBytes& file = *whole;
  const std::optional<Format> format = format_of(file.view());
  if (format == Format::kMat) return open_mat(std::move(file), damage);
  if (format == Format::kCsv) return open_csv(std::move(file), damage);
  if (format == Format::kBeamHits) return open_beam_hits(file, damage);
  if (file.bytes.empty()) return fail(Error::Code::kUnsupported, fmt::format("{}: is empty", file.name));
  return wrong_format(file.name, "a log of beams", format);
}

Result<std::unique_ptr<ScanSource>> open_any_scans(FileBytes file, Damage damage,
                                                   const std::optional<Eigen::Vector3d>& cloud_origin_m) {
  const std::optional<Format> format = format_of(file.view());
  if (format == Format::kScanGraph) return open_scan_graph(std::move(file), damage);
  if (format == Format::kScanLog) return open_scan_log(std::move(file), damage);
  if (format == Format::kXtf) return open_xtf(std::move(file), damage);
  if (format == Format::kPly) return open_ply_cloud(std::move(file), damage, cloud_origin_m);
  if (format == Format::kPcd) return open_pcd(std::move(file), damage, cloud_origin_m);
  if (format == Format::kXyz) return open_xyz(std::move(file), damage, cloud_origin_m);
  if (file.bytes.empty()) return fail(Error::Code::kUnsupported, fmt::format("{}: is empty", file.name));
  return wrong_format(file.name, "a log of scans", format);
}

/// A source whose error names the file when memory runs out, and whose note names beams longer than any head hears.
class GuardedBeams final : public BeamSourceDecorator {
 public:
  GuardedBeams(std::string name, std::unique_ptr<BeamSource> source)
      : BeamSourceDecorator(std::move(source)), name_(std::move(name)) {}

  Result<std::optional<Beam>> next() override {
    Result<std::optional<Beam>> beam = detail::without_exceptions(name_, [&] { return source().next(); });
    if (beam && *beam) look_at(**beam);
    return beam;
  }

  std::string note() const override {
    std::string own = BeamSourceDecorator::note();
    if (2 * long_beams_ <= beams_) return own;  // else damaged numbers
    return fmt::format(
        "{}{}most beams are longer than {:.0f} m, as one of {:.6g} m with bins of {:.6g} m: are lengths in metres?",
        own, own.empty() ? "" : "; ", kHeard_m, range_m_, bin_length_m_);
  }

 private:
  void look_at(const Beam& beam) {
    ++beams_;
    const double range_m = beam.bin_length_m * static_cast<double>(beam.intensities.size());
    if (range_m <= kHeard_m) return;
    ++long_beams_;
    range_m_ = range_m;
    bin_length_m_ = beam.bin_length_m;
  }

  static constexpr double kHeard_m = 310.0;  ///< a SeaKing, with another speed of sound

  std::string name_;
  std::size_t beams_ = 0, long_beams_ = 0;
  double range_m_ = 0.0, bin_length_m_ = 0.0;  ///< of a long one
};

/// The same of scans.
class GuardedScans final : public ScanSource {
 public:
  GuardedScans(std::string name, std::unique_ptr<ScanSource> source)
      : name_(std::move(name)), source_(std::move(source)) {}

  Result<std::optional<PointScan>> next() override {
    return detail::without_exceptions(name_, [&] { return source_->next(); });
  }
  std::size_t skipped() const override { return source_->skipped(); }
  std::string first_damage() const override { return source_->first_damage(); }
  std::string note() const override { return source_->note(); }
  std::optional<double> share_read() const override { return source_->share_read(); }

 private:
  std::string name_;
  std::unique_ptr<ScanSource> source_;
};

/// @param open  returns a source that may run out of memory
template <class Guarded, class Open>
auto open_guarded(const std::string& name, Open&& open) -> decltype(open()) {
  return detail::without_exceptions(name, [&]() -> decltype(open()) {
    auto source = open();
    if (!source) return source;
    return std::make_unique<Guarded>(name, *std::move(source));
  });
}

}  // namespace

Result<std::unique_ptr<BeamSource>> open_beams(ByteStream stream, Damage damage, const BeamTopic& topic) {
  const std::string name = stream.name();
  return open_guarded<GuardedBeams>(name, [&] { return open_any_beams(std::move(stream), damage, topic); });
}

Result<std::unique_ptr<BeamSource>> open_beams(FileBytes file, Damage damage, const BeamTopic& topic) {
  return open_beams(ByteStream(std::move(file)), damage, topic);
}

Result<std::unique_ptr<ScanSource>> open_scans(FileBytes file, Damage damage,
                                               const std::optional<Eigen::Vector3d>& cloud_origin_m) {
  const std::string name = file.name;
  return open_guarded<GuardedScans>(name, [&] { return open_any_scans(std::move(file), damage, cloud_origin_m); });
}

Result<BagLog> open_bag_log(ByteStream stream, Damage damage, const BeamTopic& topic) {
  const std::string name = stream.name();
  return detail::without_exceptions(name, [&]() -> Result<BagLog> {
    Result<BagLog> log = open_any_bag(std::move(stream), damage, topic);
    if (!log) return log;
    if (auto* beams = std::get_if<std::unique_ptr<BeamSource>>(&*log)) {
      return BagLog(std::make_unique<GuardedBeams>(name, std::move(*beams)));
    }
    return BagLog(std::make_unique<GuardedScans>(name, std::get<std::unique_ptr<ScanSource>>(std::move(*log))));
  });
}

Result<void> handle_damage(Damage damage, SkippedRecords& skipped, const std::string& file, const std::string& place,
                           const std::string& reason) {
  if (skipped.count++ == 0) skipped.first = fmt::format("{}: {}", place, reason);
  if (damage == Damage::kSkip) return {};
  return fail(Error::Code::kCorrupt, fmt::format("{}: {}: {}", file, place, reason));
}

Result<void> handle_damage(Damage damage, std::vector<DamageKind>& kinds, std::string_view kind,
                           const std::string& file, std::uint64_t at_byte, std::string_view reason) {
  add_damage(kinds, kind, at_byte);
  if (damage == Damage::kSkip) return {};
  return fail(Error::Code::kCorrupt, fmt::format("{}: byte {}: {}", file, at_byte, reason));
}

}  // namespace pingvox
