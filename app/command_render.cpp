#include <fmt/core.h>

#include <utility>
#include <vector>

#include "commands.hpp"
#include "open_log.hpp"
#include "pingvox/io/file.hpp"
#include "pingvox/io/maps.hpp"
#include "pingvox/sonar/sweep.hpp"
#include "pingvox/viewer/render_echoes.hpp"
#include "pingvox/viewer/render_map.hpp"

namespace pingvox::app {
namespace {

/// A picture, and what is to be seen on it.
struct Drawn {
  Picture picture;
  std::string what;
};

/// The beams to draw, with the echoes that were found in them.
class EchoGatherer {
 public:
  explicit EchoGatherer(const RenderCommand& command) : command_(command) {}

  void add(const std::optional<Sweep>& sweep) {
    if (!sweep) return;
    ++sweeps_;
    if (command_.sweep && *command_.sweep != sweeps_) return;
    const std::vector<std::optional<Echo>> found =
        detect_echoes(filtered(PolarImage(*sweep), command_.filter), *sweep, command_.echo);
    beams_.insert(beams_.end(), sweep->beams.begin(), sweep->beams.end());
    echoes_.insert(echoes_.end(), found.begin(), found.end());
  }

  Result<Drawn> draw(const std::string& name, std::size_t skipped) const {
    if (sweeps_ == 0)
      return fail(Error::Code::kCorrupt, fmt::format("{}: holds no beams ({} left out)", name, skipped));
    if (beams_.empty()) {
      return fail(Error::Code::kBadOption,
                  fmt::format("render: {}: there is no sweep {}, only {}", name, *command_.sweep, sweeps_));
    }
    std::size_t echoes = 0;
    for (const auto& echo : echoes_) echoes += echo ? 1 : 0;
    const std::string left_out = skipped > 0 ? fmt::format("; {} damaged ones left out", skipped) : "";
    return Drawn{render_echoes(beams_, echoes_, command_.echo_picture),
                 fmt::format("{} beams with {} echoes{}", beams_.size(), echoes, left_out)};
  }

 private:
  const RenderCommand& command_;
  std::size_t sweeps_ = 0;
  std::vector<Beam> beams_;
  std::vector<std::optional<Echo>> echoes_;
};

Result<Drawn> draw_log(FileBytes file, const RenderCommand& command) {
  const std::string name = file.name;
  const Result<std::unique_ptr<BeamSource>> source = open_beams(std::move(file), command.damage);
  if (!source) return tl::unexpected(source.error());
  EchoGatherer gatherer(command);
  SweepAssembler assembler;
  for (;;) {
    Result<std::optional<Beam>> beam = (*source)->next();
    if (!beam) return tl::unexpected(beam.error());
    if (!*beam) break;
    (*beam)->bin_length_m *= command.sound_speed_ratio;
    gatherer.add(assembler.add(std::move(**beam)));
  }
  gatherer.add(assembler.finish());
  return gatherer.draw(name, (*source)->skipped());
}

Result<Drawn> draw_map(const FileBytes& file, const RenderCommand& command) {
  const Result<MapFile> read = read_map(file);
  if (!read) return tl::unexpected(read.error());
  return Drawn{render_map(read->map, command.map_picture), "the map from above"};
}

Result<Drawn> draw(FileBytes file, const RenderCommand& command) {
  const Result<Format> format = recognised(file);
  if (!format) return tl::unexpected(format.error());
  switch (kind_of(*format)) {
    case FormatKind::kBeams:
      return draw_log(std::move(file), command);
    case FormatKind::kMap:
      return draw_map(file, command);
    default:
      return fail(Error::Code::kUnsupported,
                  fmt::format("{}: is {}: only logs of beams and maps can be drawn", file.name, described(*format)));
  }
}

}  // namespace

Result<int> run(const RenderCommand& command, Console& console) {
  Result<FileBytes> file = read_file(command.input);
  if (!file) return tl::unexpected(file.error());
  const Result<Drawn> drawn = draw(std::move(*file), command);
  if (!drawn) return tl::unexpected(drawn.error());

  const Picture& picture = drawn->picture;
  const Result<void> written = write_file(command.output, [&](std::ostream& out) { return write_png(picture, out); });
  if (!written) return tl::unexpected(written.error());
  const std::string summary = fmt::format("{}: {}, {} x {} pixels\n", on_one_line(command.output), drawn->what,
                                          picture.width(), picture.height());
  if (const auto told = console.summarise(summary, command.output); !told) return tl::unexpected(told.error());
  return 0;
}

}  // namespace pingvox::app
