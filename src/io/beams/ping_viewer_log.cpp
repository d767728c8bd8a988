#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "io/beams/frame_log.hpp"
#include "io/beams/stream_reader.hpp"
#include "io/bytes/byte_reader.hpp"
#include "io/bytes/date.hpp"
#include "io/readers.hpp"

// Logs of Ping Viewer: a header, then records of a time and bytes of the serial line (docs/formats.md).
namespace pingvox {
namespace {

constexpr std::string_view kViewerMagic = "PingViewer sensor log file";

/// Encoding of strings: of Qt, or of scripts that write such logs.
enum class Encoding { kUtf16, kUtf8 };

using Bytes = std::span<const std::uint8_t>;

std::uint32_t u32_at(Bytes bytes, std::size_t place) {
  return value_from<std::uint32_t>(bytes.subspan(place, 4), std::endian::big);
}

/// Removes and returns the first character; nullopt: none that may occur in a time.
std::optional<std::uint32_t> cut_character(Bytes& text, Encoding encoding) {
  if (text.empty()) return std::nullopt;
  std::size_t size = 2;
  std::uint32_t character = 0;
  if (encoding == Encoding::kUtf16) {
    if (text.size() < 2) return std::nullopt;
    character = text[0] * 256U + text[1];
  } else {
    const std::uint8_t lead = text[0];
    size = lead < 0x80 ? 1 : lead < 0xe0 ? 2 : 3;
    if (text.size() < size || (lead >= 0x80 && lead < 0xc0) || lead >= 0xf0) return std::nullopt;
    character = size == 1 ? lead : lead & (size == 2 ? 0x1fU : 0x0fU);
    for (std::size_t i = 1; i < size; ++i) character = character * 64 + (text[i] & 0x3fU);
  }
  text = text.subspan(size);
  return character;
}

/// Other characters become '?'.
std::string ascii_of(Bytes text, Encoding encoding) {
  std::string ascii;
  while (const std::optional<std::uint32_t> character = cut_character(text, encoding)) {
    ascii += *character < 0x80 ? static_cast<char>(*character) : '?';
  }
  return ascii;
}

/// Value of a decimal digit of any script (times use the digits of the writer's locale); -1: no digit.
int digit_value(std::uint32_t character) {
  constexpr std::array<std::uint32_t, 22> kZeros = {0x30,   0x660,  0x6f0,  0x7c0,  0x966,  0x9e6, 0xa66, 0xae6,
                                                    0xb66,  0xbe6,  0xc66,  0xce6,  0xd66,  0xe50, 0xed0, 0xf20,
                                                    0x1040, 0x17e0, 0x1810, 0x1946, 0xa9d0, 0xff10};
  for (const std::uint32_t zero : kZeros) {
    if (character >= zero && character < zero + 10) return static_cast<int>(character - zero);
  }
  return -1;
}

/// Seconds of "hh:mm:ss.zzz".
std::optional<double> time_in(Bytes text, Encoding encoding) {
  constexpr std::string_view kForm = "00:00:00.000";
  std::array<int, 4> fields = {};
  std::size_t field = 0;
  for (const char form : kForm) {
    const std::optional<std::uint32_t> character = cut_character(text, encoding);
    if (!character) return std::nullopt;
    if (form == '0') {
      const int digit = digit_value(*character);
      if (digit < 0) return std::nullopt;
      fields[field] = fields[field] * 10 + digit;
    } else {
      if (*character != static_cast<unsigned char>(form)) return std::nullopt;
      ++field;
    }
  }
  if (!text.empty()) return std::nullopt;
  const auto& [hours, minutes, seconds, milliseconds] = fields;
  return (hours * 60 + minutes) * 60 + seconds + milliseconds / 1000.0;
}

/// Header of a record.
struct RecordHeader {
  double time_s;
  std::size_t size;  ///< of the header [bytes]
  std::uint32_t data;
};

constexpr std::uint32_t kMaxData = 1U << 16;
/// A time of 12 characters of at most three bytes each, and two counts.
constexpr std::size_t kMaxHeader = 4 + 36 + 4;

/// nullopt: not a plausible header.
std::optional<RecordHeader> record_header_in(Bytes bytes, Encoding encoding) {
  if (bytes.size() < 4) return std::nullopt;
  const std::uint32_t text = u32_at(bytes, 0);
  const bool is_time = encoding == Encoding::kUtf16 ? text == 24 : text >= 12 && text <= 36;
  if (!is_time || bytes.size() < 4 + text + 4) return std::nullopt;
  const std::optional<double> time_s = time_in(bytes.subspan(4, text), encoding);
  const std::uint32_t data = u32_at(bytes, 4 + text);
  if (!time_s || data > kMaxData) return std::nullopt;
  return RecordHeader{*time_s, 4 + text + 4, data};
}

/// The first whole record of a log that begins anywhere.
struct FirstRecord {
  Encoding encoding;
  double time_s;
};

/// nullopt: there is none near the beginning.
std::optional<FirstRecord> first_record_in(Bytes beginning) {
  constexpr std::size_t kSearched = 16384;
  for (std::size_t at = 0; at < std::min(beginning.size(), kSearched); ++at) {
    for (const Encoding encoding : {Encoding::kUtf16, Encoding::kUtf8}) {
      const std::optional<RecordHeader> header = record_header_in(beginning.subspan(at), encoding);
      if (header) return FirstRecord{encoding, header->time_s};
    }
  }
  return std::nullopt;
}

class PingViewerRecords : public FrameContainer {
 public:
  /// @param start_s  of the log: time 0 of its records
  PingViewerRecords(StreamReader reader, Encoding encoding, double start_s)
      : reader_(std::move(reader)), encoding_(encoding), time_s_(start_s), day_s_(start_s) {}
  /// A log whose header is damaged or missing. What is before its first whole record has the time of that one, and is
  /// damage only where it is no frame.
  PingViewerRecords(StreamReader reader, const FirstRecord& first)
      : reader_(std::move(reader)), encoding_(first.encoding), time_s_(first.time_s), day_s_(0.0), in_damage_(true) {}

  const std::string& name() const override { return reader_.name(); }
  std::optional<double> share_read() const override { return reader_.share_read(); }

  /// Counts a header that says another sensor than the records hold.
  void report_wrong_header() { add_damage(damage_, "header that names another sensor", 0); }

  Result<std::optional<Piece>> next() override {
    const Result<Bytes> start = reader_.peek(kMaxHeader);
    if (!start) return tl::unexpected(start.error());
    if (start->empty()) return std::nullopt;
    const std::optional<RecordHeader> header = record_header_in(*start, encoding_);
    if (!header) return next_after_damage();
    in_damage_ = false;

    const Result<Bytes> record = reader_.peek(header->size + header->data);
    if (!record) return tl::unexpected(record.error());
    if (record->size() < header->size + header->data) {
      add_damage(damage_, FrameFinder::kCutOff, reader_.position());
    }
    set_time(header->time_s);
    const Piece piece{record->subspan(header->size), reader_.position() + header->size, 1, time_s_, 0.0};
    reader_.skip(record->size());
    return piece;
  }

 private:
  /// The bytes up to the next plausible record, which may hold frames too.
  Result<std::optional<Piece>> next_after_damage() {
    constexpr std::size_t kBlock = 4096;
    const Result<Bytes> bytes = reader_.peek(kBlock + kMaxHeader);
    if (!bytes) return tl::unexpected(bytes.error());
    if (!in_damage_) add_damage(damage_, "damaged record", reader_.position());
    in_damage_ = true;
    std::size_t passed = 1;
    const std::size_t most = bytes->size() < kBlock + kMaxHeader ? bytes->size() : kBlock;
    while (passed < most && !record_header_in(bytes->subspan(passed), encoding_)) ++passed;
    const Piece piece{bytes->first(passed), reader_.position(), 1, time_s_, 0.0};
    reader_.skip(passed);
    return piece;
  }

  /// Unwraps times, which restart after a day.
  void set_time(double time_s) {
    constexpr double kDay_s = 86400.0;
    if (time_s + day_s_ < time_s_ - kDay_s / 2) day_s_ += kDay_s;
    time_s_ = time_s + day_s_;
  }

  StreamReader reader_;
  Encoding encoding_;
  double time_s_;
  double day_s_;  ///< time at which those of the records began (again)
  bool in_damage_ = false;
};

/// Whether these records hold a ping of a Ping360.
bool hold_ping360(Bytes records, Encoding encoding) {
  StreamReader reader{ByteStream(FileBytes{{}, {records.begin(), records.end()}})};
  auto container = std::make_unique<PingViewerRecords>(std::move(reader), encoding, 0.0);
  return beams_of(std::move(container), ping_protocol(), Damage::kSkip)->device() != nullptr;
}

std::optional<Encoding> encoding_of(Bytes bytes) {
  if (bytes.size() < 4) return std::nullopt;
  const bool is_wide = u32_at(bytes, 0) == 2 * kViewerMagic.size();
  if (!is_wide && u32_at(bytes, 0) != kViewerMagic.size()) return std::nullopt;
  const Encoding encoding = is_wide ? Encoding::kUtf16 : Encoding::kUtf8;
  Bytes text = bytes.subspan(4);
  for (const char wanted : kViewerMagic) {
    if (cut_character(text, encoding) != static_cast<unsigned char>(wanted)) return std::nullopt;
  }
  return encoding;
}

}  // namespace

bool looks_like_ping_viewer(Bytes beginning) {
  return encoding_of(beginning).has_value();
}

bool looks_like_cut_ping_viewer(Bytes beginning) {
  return first_record_in(beginning).has_value();
}

Result<std::unique_ptr<BeamSource>> open_ping_viewer(ByteStream stream, Damage damage) {
  constexpr std::int32_t kPingFamily = 1, kPing1d = 1, kPing360 = 2;
  constexpr std::uint32_t kNullString = 0xffffffff;
  StreamReader reader(std::move(stream));
  const std::string name = reader.name();
  const Result<Bytes> beginning = reader.peek(ByteStream::kBeginning);
  if (!beginning) return tl::unexpected(beginning.error());
  const std::optional<Encoding> encoding = encoding_of(*beginning);
  ByteReader header(*beginning, std::endian::big);
  const auto cut_string = [&header]() -> std::optional<Bytes> {
    const auto size = header.read<std::uint32_t>();
    if (!size) return std::nullopt;
    return *size == kNullString ? Bytes() : header.take(*size);
  };
  bool is_whole = encoding && cut_string() && header.read<std::uint32_t>();
  std::array<std::optional<Bytes>, 5> about;  // build, its date, name; name and version of the system
  for (std::optional<Bytes>& text : about) {
    if (is_whole) text = cut_string();
    is_whole = is_whole && text;
  }
  const auto family = header.read<std::int32_t>(), type = header.read<std::int32_t>();
  if (!is_whole || !family || !type) {
    if (const auto first = first_record_in(*beginning)) {
      return beams_of(std::make_unique<PingViewerRecords>(std::move(reader), *first), ping_protocol(), damage);
    }
    return fail(Error::Code::kCorrupt, fmt::format("{}: its header is damaged or cut off", name));
  }
  // Ping Viewer has written Ping1D above pings of a Ping360.
  const bool is_ping360 = family == kPingFamily && type == kPing360;
  const bool is_wrong = !is_ping360 && hold_ping360(beginning->subspan(header.position()), *encoding);
  if (!is_wrong && family == kPingFamily && type == kPing1d) {
    return fail(Error::Code::kUnsupported,
                fmt::format("{}: is a Ping Viewer log of a Ping1D, an echosounder that looks one way: only those of a "
                            "Ping360 hold beams",
                            name));
  }
  if (!is_wrong && !is_ping360) {
    return fail(Error::Code::kUnsupported,
                fmt::format("{}: is a Ping Viewer log of an unknown sensor (family {}, type {}): only those of a "
                            "Ping360 hold beams",
                            name, *family, *type));
  }
  // Our recordings have the date of their start there.
  const double start_s = date_time_s(ascii_of(*about[1], *encoding)).value_or(0.0);
  reader.skip(header.position());
  auto records = std::make_unique<PingViewerRecords>(std::move(reader), *encoding, start_s);
  if (is_wrong) records->report_wrong_header();
  return beams_of(std::move(records), ping_protocol(), damage);
}

}  // namespace pingvox
