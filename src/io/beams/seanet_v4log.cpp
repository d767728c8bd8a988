#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "io/beams/device_log.hpp"
#include "io/beams/stream_reader.hpp"
#include "io/bytes/byte_reader.hpp"
#include "io/bytes/text.hpp"
#include "io/internal/frame_finder.hpp"
#include "io/internal/seanet_frame.hpp"
#include "io/readers.hpp"

// Logs of Tritech's own program (docs/formats.md): a header, settings, then records with the messages of the heads.
namespace pingvox {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::string_view kV4Magic = "SeaNetV4 Log File V";

/// Of a record: offsets of its time, its sender, its message and mtHeadData's device block; minimum and maximum size.
constexpr std::size_t kV4Time = 2, kFrom = 10, kMessage = 12, kV4DeviceBlock = 17, kMinRecord = 17, kMaxRecord = 4096;
constexpr std::uint8_t kV4HeadData = 2;

template <class T>
T value_at(Bytes bytes, std::size_t place) {
  return value_from<T>(bytes.subspan(place, sizeof(T)), std::endian::little);
}

/// Seconds since 1970 from days since the end of 1899; nullopt: before 1970 or after 2100.
std::optional<double> time_s_of(double days) {
  constexpr double kDaysTo1970 = 25569.0, kDaysTo2100 = 73051.0;
  if (!(days > kDaysTo1970 && days < kDaysTo2100)) return std::nullopt;
  return (days - kDaysTo1970) * 86400.0;
}

/// Size of the record at the start of `bytes`; nullopt: not a plausible record.
std::optional<std::size_t> record_size(Bytes bytes) {
  if (bytes.size() < kMinRecord) return std::nullopt;
  const std::size_t size = value_at<std::uint16_t>(bytes, 0);
  if (size < kMinRecord || size > kMaxRecord || !time_s_of(value_at<double>(bytes, kV4Time))) return std::nullopt;
  // mtHeadData also holds its own length.
  const bool is_line = bytes[kMessage] == kV4HeadData;
  if (is_line && value_at<std::uint16_t>(bytes, kV4DeviceBlock - 2) + kV4DeviceBlock - 2U != size) return std::nullopt;
  return size;
}

class V4Log final : public DeviceLog {
 public:
  /// @param end      of the records; nullopt: end of the file
  /// @param records  that there are; 0: the log was not closed
  V4Log(StreamReader reader, std::optional<std::uint64_t> end, std::size_t records, Damage damage)
      : reader_(std::move(reader)), end_(end), missing_(records), damage_(damage) {
    set_first(read());
  }
  std::vector<DamageKind> damage() const override { return kinds_; }
  std::optional<double> share_read() const override { return reader_.share_read(); }

 private:
  Result<std::optional<Beam>> read() override {
    for (;;) {
      const Result<Bytes> bytes = reader_.peek(kMaxRecord);
      if (!bytes) return tl::unexpected(bytes.error());
      if (end_ && reader_.position() >= *end_) {
        if (const auto counted = check_end(*bytes); !counted) return tl::unexpected(counted.error());
        if (end_) return std::nullopt;
      }
      if (bytes->empty()) {
        if (end_ && !in_damage_) {
          if (const auto counted = report_damage(FrameFinder::kCutOff, "records are missing"); !counted) {
            return tl::unexpected(counted.error());
          }
        }
        return std::nullopt;
      }
      const std::optional<std::size_t> size = record_size(*bytes);
      if (!size || *size > bytes->size()) {
        if (!in_damage_) {
          const bool is_cut = bytes->size() < kMaxRecord && (size || bytes->size() < kMinRecord);
          const auto counted = is_cut ? report_damage(FrameFinder::kCutOff, "a record is cut off")
                                      : report_damage("damaged record", "its length or its time is damaged");
          if (!counted) return tl::unexpected(counted.error());
        }
        in_damage_ = true;
        reader_.skip(1);
        continue;
      }
      in_damage_ = false;
      const Bytes record = bytes->first(*size);
      missing_ -= missing_ > 0 ? 1 : 0;
      if (record[kMessage] == kV4HeadData) {
        tl::expected<Beam, std::string> beam = beam_in(record);
        const bool is_other = beam && !is_of_first_head(record[kFrom]);
        if (is_other) beam = tl::unexpected(std::string(kOtherHead));
        if (!beam) {
          const auto counted = report_damage(is_other ? kOtherHead : damage_kind_of(beam.error()), beam.error());
          if (!counted) return tl::unexpected(counted.error());
        }
        reader_.skip(*size);
        if (beam) return std::move(*beam);
      } else {
        reader_.skip(*size);
      }
    }
  }

  /// Where the header says that the records end: forgets that place when a beam follows, for the header is damaged, and
  /// counts records that the header has and the log has not.
  Result<void> check_end(Bytes behind) {
    const std::optional<std::size_t> size = record_size(behind);
    if (size && *size <= behind.size() && behind[kMessage] == kV4HeadData) {
      end_.reset();
      return report_damage("damaged header", "records follow after the end given by the header");
    }
    const bool is_short = std::exchange(missing_, 0) > 0 && kinds_.empty();
    return is_short ? report_damage("damaged header", "records are missing") : Result<void>();
  }

  tl::expected<Beam, std::string> beam_in(Bytes record) {
    const auto line = seanet_line_in(record.subspan(kV4DeviceBlock));
    if (!line) return tl::unexpected(std::string(line.error()));
    if (device_ == nullptr) device_ = device_of(*line);
    return beam_of(*line, *time_s_of(value_at<double>(record, kV4Time)));
  }

  /// Counts damage at the reader's position, or fails.
  Result<void> report_damage(std::string_view kind, std::string_view reason) {
    return handle_damage(damage_, kinds_, kind, reader_.name(), reader_.position(), reason);
  }

  StreamReader reader_;
  std::optional<std::uint64_t> end_;
  std::size_t missing_;  ///< records that are still to come
  Damage damage_;
  bool in_damage_ = false;
  std::vector<DamageKind> kinds_;
};

}  // namespace

bool looks_like_v4log(Bytes beginning) {
  return text_of(beginning).starts_with(kV4Magic);
}

Result<std::unique_ptr<BeamSource>> open_v4log(ByteStream stream, Damage damage) {
  constexpr std::size_t kHeader = 0x50, kFirstRecord = 0x28, kRecords = 0x2c, kEndOfRecords = 0x30;
  StreamReader reader(std::move(stream));
  const Result<Bytes> header = reader.peek(kHeader);
  if (!header) return tl::unexpected(header.error());
  const auto header_error = [&] {
    return fail(Error::Code::kCorrupt, fmt::format("{}: its header is damaged or cut off", reader.name()));
  };
  if (header->size() < kHeader) return header_error();
  const auto first = value_at<std::uint32_t>(*header, kFirstRecord);
  const auto end = value_at<std::uint32_t>(*header, kEndOfRecords);
  if (first < kHeader) return header_error();
  while (reader.position() < first) {
    const Result<Bytes> settings = reader.peek(std::min<std::size_t>(first - reader.position(), 4096));
    if (!settings) return tl::unexpected(settings.error());
    if (settings->empty()) return header_error();
    reader.skip(settings->size());
  }
  // Logs that were not closed hold no end.
  return std::make_unique<V4Log>(std::move(reader), end > first ? std::optional<std::uint64_t>(end) : std::nullopt,
                                 value_at<std::uint32_t>(*header, kRecords), damage);
}

}  // namespace pingvox
