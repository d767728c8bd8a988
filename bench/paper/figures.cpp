#include "figures.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <string>
#include <system_error>

#include "claim.hpp"
#include "early_drop.hpp"
#include "maps.hpp"
#include "pingvox/io/file.hpp"
#include "ray_figures.hpp"
#include "tank_figures.hpp"

namespace pingvox::bench {
namespace {

/// Writes figures into a folder and collects a row for each.
class Folder {
 public:
  explicit Folder(std::filesystem::path path) : path_(std::move(path)) {}

  Result<void> add(const std::string& name, const std::string& section, const std::string& says,
                   const Result<Picture>& picture) {
    if (!picture) return tl::unexpected(picture.error());
    const std::string file = name + ".png";
    Result<void> written =
        write_file((path_ / file).string(), [&](std::ostream& out) { return write_png(*picture, out); });
    if (!written) return written;
    rows_.push_back(row_of({.name = name,
                            .section = section,
                            .unit = "picture",
                            .paper = says,
                            .ours = file,
                            .checked = true,
                            .why = "docs/paper.md says what is to be seen"}));
    return {};
  }

  const std::vector<Row>& rows() const { return rows_; }

 private:
  std::filesystem::path path_;
  std::vector<Row> rows_;
};

}  // namespace

Result<std::vector<Row>> paper_figures(const BenchOptions& options) {
  if (!options.pictures) return fail(Error::Code::kBadOption, "wants a folder: --pictures DIR");
  std::error_code error;
  std::filesystem::create_directories(*options.pictures, error);
  if (error) return fail(Error::Code::kIo, fmt::format("{}: {}", *options.pictures, error.message()));
  const auto logs = tank_logs();
  if (!logs) return tl::unexpected(logs.error());

  Folder folder(*options.pictures);
  for (const TankLog& log : *logs) {
    const auto figures = tank_figures(log);
    if (!figures) return tl::unexpected(figures.error());
    for (const TankFigure& figure : *figures) {
      const auto added = folder.add(figure.name + "-" + log.name, figure.section, figure.says, figure.picture);
      if (!added) return tl::unexpected(added.error());
    }
  }
  if (const auto added = folder.add("section-3", "3", "grid, features, octree", harbour_and_its_lines()); !added) {
    return tl::unexpected(added.error());
  }
  if (const auto added = folder.add("figure-8", "5.3", "slower, slightly faster, much faster", early_drop_chart());
      !added) {
    return tl::unexpected(added.error());
  }
  if (const auto added = folder.add("figure-9-10", "6", "a line like a laser's, and faces", diagonal_rays()); !added) {
    return tl::unexpected(added.error());
  }
  if (const auto added = folder.add("figure-11-12", "6.1", "missing the end, snapping", lost_ends()); !added) {
    return tl::unexpected(added.error());
  }
  return folder.rows();
}

}  // namespace pingvox::bench
