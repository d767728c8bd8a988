#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/without_exceptions.hpp"
#include "io/internal/deflate.hpp"
#include "pingvox/web/page.hpp"
#include "pingvox/web/scene_bytes.hpp"

namespace pingvox::web {
namespace {

constexpr std::string_view kPolicy =
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'unsafe-inline'; "
    "worker-src blob:; style-src 'unsafe-inline'; img-src data: blob:; base-uri 'none'; form-action 'none'\">";

std::string base64_of(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t given = std::min<std::size_t>(bytes.size() - i, 3);
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (k < given ? bytes[i + k] : 0U);
    for (std::size_t digit = 0; digit < 4; ++digit) {
      text += digit <= given ? kDigits[word >> (18 - 6 * digit) & 63] : '=';
    }
  }
  return text;
}

/// An answer within the page: compressed, as base64, which holds no tag.
Result<std::string> data_element(std::string_view url, std::span<const std::uint8_t> bytes) {
  return deflate_raw(bytes).map([&](const Bytes& packed) {
    return fmt::format("<script type=\"application/octet-stream\" id=\"{}\">{}</script>\n", url, base64_of(packed));
  });
}

/// Replaces all occurrences.
std::string replaced(std::string text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

/// A script or a style that does not end its element before its end.
std::string as_inline(std::string_view text) {
  return replaced(replaced(replaced(std::string(text), "</script", "<\\/script"), "</style", "<\\/style"), "<!--",
                  "<\\!--");
}

/// Takes the tag that names a file of the page out of the HTML. kCorrupt when there is none.
Result<void> cut_tag(std::string& html, std::string_view name, std::string_view begin, std::string_view end) {
  const std::size_t at = html.find(fmt::format("\"{}\"", name));
  const std::size_t first = at == std::string::npos ? at : html.rfind(begin, at);
  const std::size_t last = at == std::string::npos ? at : html.find(end, at);
  if (first == std::string::npos || last == std::string::npos) {
    return fail(Error::Code::kCorrupt, fmt::format("the page does not name {}", name));
  }
  html.erase(first, last + end.size() - first);
  return {};
}

Result<void> insert_before(std::string& html, std::string_view tag, std::string_view text) {
  const std::size_t at = html.rfind(tag);
  if (at == std::string::npos) return fail(Error::Code::kCorrupt, fmt::format("the page has no {}", tag));
  html.insert(at, text);
  return {};
}

/// The page around the data: script and style are within it, data go before the script.
struct Shell {
  std::string before, behind;
  std::size_t bytes() const { return before.size() + behind.size(); }
};

Result<Shell> shell_of(const Page& page) {
  std::string html(page.html);
  const auto parts = cut_tag(html, "page.js", "<script", "</script>")
                         .and_then([&] { return cut_tag(html, "page.css", "<link", ">"); })
                         .and_then([&] {
                           return insert_before(html, "</head>",
                                                fmt::format("{}\n<style>{}</style>\n", kPolicy, as_inline(page.style)));
                         });
  if (!parts) return tl::unexpected(parts.error());
  const std::size_t end = html.rfind("</body>");
  if (end == std::string::npos) return fail(Error::Code::kCorrupt, "the page has no </body>");
  return Shell{html.substr(0, end), fmt::format("<script>{}</script>\n{}", as_inline(page.script), html.substr(end))};
}

/// All of the scene but the list of what there is and the intensities of logs.
Result<std::string> fixed_elements(const Scene& scene) {
  std::string all;
  const auto add = [&all](std::string_view url, std::span<const std::uint8_t> bytes) {
    return data_element(url, bytes).map([&all](const std::string& element) { all += element; });
  };
  const auto add_result = [&](const std::string& url, const Result<Bytes>& bytes) -> Result<void> {
    return bytes ? add(url, *bytes) : tl::unexpected(bytes.error());
  };
  Result<void> added;
  for (std::size_t id = 0; added && id < scene.maps.size(); ++id) {
    const SceneMap& map = scene.maps[id];
    added = add_result(fmt::format("map/{}/cells", id), cells_bytes(map.map)).and_then([&]() -> Result<void> {
      // The list of the scene has no address for them then.
      if (map.map.counts().leaves > kMaxFreeLeaves) return {};
      return add_result(fmt::format("map/{}/free", id), free_bytes(map.map));
    });
    if (added && !map.agreement.empty()) {
      added = add_result(fmt::format("map/{}/agreement", id), agreement_bytes(map));
    }
  }
  for (std::size_t id = 0; added && id < scene.paths.size(); ++id) {
    added = add(fmt::format("path/{}", id), path_bytes(scene.paths[id], scene.origin_m()));
  }
  for (std::size_t id = 0; added && id < scene.points.size(); ++id) {
    added = add(fmt::format("points/{}", id), points_bytes(scene.points[id], scene.origin_m()));
  }
  if (!added) return tl::unexpected(added.error());
  return all;
}

/// How the intensities of all logs are reduced.
struct Reduction {
  std::size_t group = 1;
  int step = 1;
};

Result<std::string> log_elements(const std::vector<SceneLog>& logs) {
  std::string all;
  for (std::size_t id = 0; id < logs.size(); ++id) {
    Result<std::string> beams = data_element(fmt::format("log/{}", id), beams_bytes(logs[id]));
    if (!beams) return beams;
    Result<std::string> bins = data_element(fmt::format("log/{}/bins", id), logs[id].intensities);
    if (!bins) return bins;
    all += *beams + *bins;
  }
  return all;
}

/// The logs as they are in the page.
struct ReducedLogs {
  std::vector<SceneLog> logs;
  std::string elements;
  Reduction by;
};

Result<ReducedLogs> logs_within(const std::vector<SceneLog>& logs, std::size_t wanted_bytes) {
  // Fewer levels are hardly seen; fewer bins are.
  constexpr std::array kReductions = {Reduction{1, 1},  Reduction{1, 8},  Reduction{1, 16}, Reduction{2, 16},
                                      Reduction{4, 16}, Reduction{8, 16}, Reduction{16, 32}};
  // No picture of a sonar packs better, so it need not be tried.
  constexpr std::size_t kBestPacking = 20;
  std::size_t bytes = 0;
  for (const SceneLog& log : logs) bytes += log.intensities.size();
  ReducedLogs last;
  for (const Reduction& by : kReductions) {
    if (bytes / by.group / kBestPacking > wanted_bytes && by.group < kReductions.back().group) continue;
    last = {{}, {}, by};
    for (const SceneLog& log : logs) last.logs.push_back(reduced(log, by.group, by.step));
    Result<std::string> elements = log_elements(last.logs);
    if (!elements) return tl::unexpected(elements.error());
    last.elements = *std::move(elements);
    if (last.elements.size() <= wanted_bytes) break;
  }
  return last;
}

/// The note on reduced logs; empty: they are not.
std::string reduction_note(const Reduction& by) {
  if (by.step == 1) return {};
  std::string text = fmt::format("to limit the file size, intensities are rounded to multiples of {}", by.step);
  if (by.group > 1) text += fmt::format(" and {} bins are joined", by.group);
  return text + "; the map is made from the full log";
}

Result<std::string> page_text(Scene scene, const Page& page, const ExportOptions& options) {
  const Result<Shell> shell = shell_of(page);
  if (!shell) return tl::unexpected(shell.error());
  Result<std::string> fixed = fixed_elements(scene);
  if (!fixed) return fixed;
  const std::size_t used = shell->bytes() + fixed->size();
  const std::size_t left = options.wanted_bytes - std::min(options.wanted_bytes, used);
  Result<ReducedLogs> reduced_logs = logs_within(scene.logs, left);
  if (!reduced_logs) return tl::unexpected(reduced_logs.error());
  scene.logs = std::move(reduced_logs->logs);
  if (std::string note = reduction_note(reduced_logs->by); !scene.logs.empty() && !note.empty()) {
    scene.notes.push_back(std::move(note));
  }
  const std::string json = scene_json(scene);
  const Bytes json_bytes(json.begin(), json.end());
  return data_element("scene.json", json_bytes).map([&](const std::string& list) {
    return shell->before + list + *fixed + reduced_logs->elements + shell->behind;
  });
}

}  // namespace

Result<void> ExportOptions::validate() const {
  if (wanted_bytes > 0) return {};
  return fail(Error::Code::kBadOption, "wanted_bytes must be above 0");
}

Result<void> write_page(Scene scene, const Page& page, std::ostream& out, const ExportOptions& options) {
  if (const auto valid = options.validate(); !valid) return valid;
  const Result<std::string> text =
      detail::without_exceptions([&] { return page_text(std::move(scene), page, options); });
  if (!text) return tl::unexpected(text.error());
  out << *text;
  out.flush();
  if (!out) return fail(Error::Code::kIo, "the page could not be written");
  return {};
}

}  // namespace pingvox::web
