#include "log_reading.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

#include "bench/paired_timing.hpp"
#include "io/internal/ping_frame.hpp"
#include "pingvox/io/beams.hpp"
#include "pingvox/io/file.hpp"

namespace pingvox::bench {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kBeams = 20'000, kBins = 1200;

void put(Bytes& bytes, std::uint64_t value, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

void put_bytes(Bytes& bytes, std::initializer_list<std::uint8_t> more) {
  bytes.insert(bytes.end(), more);
}

Bytes samples(std::size_t beam) {
  Bytes bins(kBins);
  for (std::size_t i = 0; i < kBins; ++i) bins[i] = static_cast<std::uint8_t>(beam + i * i / 64);
  return bins;
}

/// A Ping360's answer with the samples of one ping.
Bytes ping_frame(std::size_t beam) {
  Bytes payload = {0, 1};
  for (const std::size_t value : {beam % 400, std::size_t{80}, std::size_t{666}, std::size_t{750}, kBins, kBins}) {
    put(payload, value, 2);
  }
  const Bytes bins = samples(beam);
  payload.insert(payload.end(), bins.begin(), bins.end());
  return make_ping_frame(PingMessage::kDeviceData, 2, 0, payload);
}

/// A line of a SeaNet head.
Bytes seanet_frame(std::size_t beam) {
  constexpr std::size_t kBefore = 44;
  const std::size_t length = kBefore + kBins + 1 - 6;
  Bytes frame = {'@'};
  for (const char digit : fmt::format("{:04X}", length)) frame.push_back(static_cast<std::uint8_t>(digit));
  put(frame, length, 2);
  put_bytes(frame, {2, 255, 0, 2, 0x80, 2});
  put(frame, length - 8, 2);
  put_bytes(frame, {0x11, 0x10, 0});
  put(frame, 0x2307, 2);
  put(frame, 60, 2);
  put(frame, 0, 4);
  put_bytes(frame, {84, 0, 0, 81, 8, 0, 0});
  for (const std::size_t value : {std::size_t{50}, std::size_t{2400}, std::size_t{4000}}) put(frame, value, 2);
  frame.push_back(16);
  put(frame, beam * 16 % 6400, 2);
  put(frame, kBins, 2);
  const Bytes bins = samples(beam);
  frame.insert(frame.end(), bins.begin(), bins.end());
  frame.push_back('\n');
  return frame;
}

template <class FrameOf>
Bytes capture(FrameOf frame_of) {
  Bytes log;
  for (std::size_t beam = 0; beam < kBeams; ++beam) {
    const Bytes frame = frame_of(beam);
    log.insert(log.end(), frame.begin(), frame.end());
  }
  return log;
}

/// A log of Ping Viewer, one frame a record.
Bytes ping_viewer_log() {
  Bytes log;
  const auto put_size = [&](std::size_t size) {
    for (int shift = 24; shift >= 0; shift -= 8) log.push_back(static_cast<std::uint8_t>(size >> shift));
  };
  const auto put_text = [&](std::string_view text) {
    put_size(2 * text.size());
    for (const char c : text) {
      log.push_back(0);
      log.push_back(static_cast<std::uint8_t>(c));
    }
  };
  put_text("PingViewer sensor log file");
  put_size(1);
  for (int i = 0; i < 5; ++i) put_text("");
  put_size(1);
  put_size(2);
  for (std::size_t beam = 0; beam < kBeams; ++beam) {
    const std::size_t time_s = beam / 10;
    put_text(fmt::format("{:02}:{:02}:{:02}.{}00", time_s / 3600, time_s / 60 % 60, time_s % 60, beam % 10));
    const Bytes frame = ping_frame(beam);
    put_size(frame.size());
    log.insert(log.end(), frame.begin(), frame.end());
  }
  return log;
}

/// Beams of a log; an error when a byte of it is damaged.
Result<std::size_t> count_beams(FileBytes log) {
  const auto source = open_beams(std::move(log), Damage::kFail);
  if (!source) return tl::unexpected(source.error());
  for (std::size_t beams = 0;; ++beams) {
    const Result<std::optional<Beam>> beam = (*source)->next();
    if (!beam) return tl::unexpected(beam.error());
    if (!*beam) return beams;
  }
}

Result<Row> measure(std::string_view name, const FileBytes& log, std::size_t beams) {
  constexpr int kRuns = 5;
  constexpr double kMega = 1e6;
  std::vector<double> speeds;
  for (int run = 0; run < kRuns; ++run) {
    FileBytes copy = log;
    const double before_s = cpu_time_s();
    const Result<std::size_t> count = count_beams(std::move(copy));
    const double took_s = cpu_time_s() - before_s;
    if (!count) return tl::unexpected(count.error());
    if (*count != beams) {
      return fail(Error::Code::kCorrupt, fmt::format("{}: {} beams were read, not {}", name, *count, beams));
    }
    speeds.push_back(static_cast<double>(log.bytes.size()) / kMega / took_s);
  }
  const auto [min, max] = std::minmax_element(speeds.begin(), speeds.end());
  Row row;
  row.add("name", name)
      .add_truth("checked", true)
      .add("megabytes", static_cast<double>(log.bytes.size()) / kMega)
      .add("mb_per_s", median(speeds))
      .add("mb_per_s_min", *min)
      .add("mb_per_s_max", *max);
  return row;
}

}  // namespace

Result<std::vector<Row>> log_reading(const BenchOptions&) {
  struct Log {
    std::string_view name;
    Bytes bytes;
    std::size_t beams;
  };
  std::vector<Log> logs;
  logs.push_back({"log-pingviewer", ping_viewer_log(), kBeams});
  logs.push_back({"log-svlog", capture(ping_frame), kBeams});
  logs.push_back({"log-seanet", capture(seanet_frame), kBeams});
  const std::filesystem::path bag =
      std::filesystem::path(PINGVOX_SHARED_DATA) / "micron-ratzeburg-bag/RatzeburgerSee-2019-01-22-15-05-01.bag";
  if (std::filesystem::exists(bag)) {
    Result<FileBytes> file = read_file(bag.string());
    if (!file) return tl::unexpected(file.error());
    const Result<std::size_t> beams = count_beams(*file);
    if (!beams) return tl::unexpected(beams.error());
    logs.push_back({"log-bag", std::move(file->bytes), *beams});
  }
  std::vector<Row> rows;
  for (Log& log : logs) {
    Result<Row> row = measure(log.name, {std::string(log.name), std::move(log.bytes)}, log.beams);
    if (!row) return tl::unexpected(row.error());
    rows.push_back(*std::move(row));
  }
  return rows;
}

}  // namespace pingvox::bench
