// Drives a Ping360, records it, and maps it along the poses that an autopilot sends (without one the vehicle stands
// still), until Ctrl-C. The map is written every ten seconds and at the end: `pingvox live`, less its status.
//
//   02_live dive.ot dive.bin udp://192.168.2.2:9092 [udp://:14550]
#include <csignal>
#include <cstdio>
#include <pingvox/live/live_mapping.hpp>
#include <pingvox/live/map_writer.hpp>

volatile std::sig_atomic_t is_stopped = 0;

int report(const pingvox::Error& error) {
  std::fprintf(stderr, "%s\n", error.message.c_str());
  return 1;
}

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "Usage: 02_live MAP LOG HEAD [AUTOPILOT]\n");
    return 2;
  }
  pingvox::LiveOptions options = {.head = {.address = argv[3]}, .record = argv[2], .map = {.resolution_m = 0.1}};
  if (argc > 4) options.nav = {{.kind = pingvox::LiveNav::Kind::kMavlink, .address = argv[4]}};
  auto live = pingvox::LiveMapping::open(options);
  if (!live) return report(live.error());
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { is_stopped = 1; });

  int status = 0;
  pingvox::MapWriter writer(argv[1]);
  for (double write_at_s = 10.0; is_stopped == 0;) {
    live->wait(1.0);
    auto goes_on = live->step();
    if (!goes_on) status = report(goes_on.error());
    for (const pingvox::LiveEvent& event : live->take_events()) {
      if (const pingvox::Error* error = pingvox::error_of(event)) status = report(*error);
    }
    if (!goes_on.value_or(false)) break;
    if (live->time_s() < write_at_s || live->report().beams == 0) continue;
    if (auto written = writer.write(live->map()); !written) status = report(written.error());
    write_at_s += 10.0;
  }
  if (auto finished = live->finish(); !finished) status = report(finished.error());
  if (auto written = writer.finish(live->map()); !written) status = report(written.error());
  std::printf("%zu beams, %zu mapped\n", live->beams(), live->report().beams);
  return status;
}
