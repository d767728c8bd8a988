#include "pingvox/web/answer.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <system_error>

namespace pingvox::web {
namespace {

constexpr std::string_view kBinary = "application/octet-stream", kJson = "application/json; charset=utf-8";

Answer answer_of(Bytes bytes, std::string_view type) {
  Answer answer;
  answer.type = type;
  answer.owned = std::make_shared<const Bytes>(std::move(bytes));
  answer.body = *answer.owned;
  return answer;
}

Answer answer_of_text(int status, std::string_view text) {
  Answer answer = answer_of(Bytes(text.begin(), text.end()), Answer{}.type);
  answer.status = status;
  return answer;
}

Answer answer_with(std::string_view part, std::string_view type) {
  return answer_of(Bytes(part.begin(), part.end()), type);
}

Answer not_found() {
  return answer_of_text(404, "not found\n");
}

Answer answer_of(Result<Bytes> bytes) {
  if (bytes) return answer_of(*std::move(bytes), kBinary);
  return answer_of_text(500, bytes.error().message + "\n");
}

/// A number in digits alone.
std::optional<std::size_t> number_of(std::string_view text) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_digits = std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
  if (text.empty() || !is_digits || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

/// What is before the next separator; the rest stays in `text`.
std::string_view take_until(char separator, std::string_view& text) {
  const std::size_t at = text.find(separator);
  const std::string_view taken = text.substr(0, at);
  text = at == std::string_view::npos ? std::string_view() : text.substr(at + 1);
  return taken;
}

bool is_address(std::string_view host) {
  if (host.starts_with('[')) return host.ends_with(']');
  return !host.empty() && std::ranges::all_of(host, [](char c) { return (c >= '0' && c <= '9') || c == '.'; });
}

/// Whether a Host header, "localhost:8080", names this server. A page of another origin whose name leads here names
/// itself.
bool is_own_host(std::string_view host, const Access& access) {
  std::string_view name = host;
  int port = 80;
  const std::size_t colon = host.rfind(':');
  if (colon != std::string_view::npos && host.find(']', colon) == std::string_view::npos) {
    const std::optional<std::size_t> number = number_of(host.substr(colon + 1));
    if (!number || *number > 65535) return false;
    port = static_cast<int>(*number);
    name = host.substr(0, colon);
  }
  if (port != access.port) return false;
  return std::ranges::find(access.hosts, name) != access.hosts.end() || (access.any_address && is_address(name));
}

/// Whether a page of another origin wants to read. Links to the page itself may be anywhere.
bool is_foreign(const Request& request, bool is_page) {
  if (request.origin && *request.origin != "http://" + *request.host) return true;
  if (!request.fetch_site || *request.fetch_site == "same-origin" || *request.fetch_site == "none") return false;
  return !is_page || request.fetch_mode != "navigate" || request.fetch_dest != "document";
}

/// Beams from one number up to, without, another.
struct BeamRange {
  std::size_t from = 0, to = 0;
};

/// "from=2&to=9"; of another query one that no log has.
BeamRange range_of(std::string_view query) {
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  constexpr std::string_view kFrom = "from=", kTo = "to=";
  const std::string_view first = take_until('&', query);
  if (!first.starts_with(kFrom) || !query.starts_with(kTo)) return {.from = kNone, .to = 0};
  return {.from = number_of(first.substr(kFrom.size())).value_or(kNone),
          .to = number_of(query.substr(kTo.size())).value_or(kNone)};
}

/// The item that the id in a path names; nullptr: there is none.
template <class Item>
const Item* find_item(const std::vector<Item>& items, std::string_view id) {
  const std::optional<std::size_t> number = number_of(id);
  const bool is_plain = id.size() == 1 || !id.starts_with('0');
  return number && is_plain && *number < items.size() ? &items[*number] : nullptr;
}

}  // namespace

std::span<const Header> fixed_headers() {
  static constexpr std::array kHeaders = {
      Header{"Content-Security-Policy",
             "default-src 'none'; script-src 'self'; worker-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
             "connect-src 'self'; "
             "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
      Header{"X-Content-Type-Options", "nosniff"},
      Header{"Cache-Control", "no-store"},
      Header{"Cross-Origin-Resource-Policy", "same-origin"},
      Header{"Referrer-Policy", "no-referrer"},
  };
  return kHeaders;
}

bool is_same_secret(std::string_view given, std::string_view wanted) {
  unsigned different = given.size() == wanted.size() ? 0 : 1;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const char c = given.empty() ? '\0' : given[std::min(i, given.size() - 1)];
    different |= static_cast<unsigned char>(c) ^ static_cast<unsigned char>(wanted[i]);
  }
  return different == 0;
}

Answer Answers::answer(const Request& request, const Access& access) const {
  constexpr std::size_t kLongestTarget = 256;
  if (request.target.size() > kLongestTarget) return answer_of_text(414, "the path is too long\n");
  if (!request.host) return answer_of_text(400, "the request names no host, or several\n");
  if (!is_own_host(*request.host, access)) {
    return answer_of_text(403, "this is not the host that the address on the terminal names\n");
  }
  std::string_view query = request.target;
  std::string_view path = take_until('?', query);
  if (!path.starts_with('/')) return not_found();
  path.remove_prefix(1);
  if (!access.token.empty()) {
    std::string_view rest = path;
    const bool is_known = is_same_secret(take_until('/', rest), access.token);
    // Without the slash behind it the page would not find its parts.
    if (!is_known || path.size() == access.token.size()) {
      return answer_of_text(403, "the address is not complete: copy all of it from the terminal\n");
    }
    path = rest;
  }
  if (is_foreign(request, path.empty())) return answer_of_text(403, "only the page itself may read this\n");
  if (request.method != "GET") return answer_of_text(405, "only GET is answered\n");
  return content_of(path, query);
}

Answer Answers::content_of(std::string_view path, std::string_view query) const {
  if (path.empty()) return answer_with(page_.html, "text/html; charset=utf-8");
  if (path == "page.js") return answer_with(page_.script, "text/javascript; charset=utf-8");
  if (path == "page.css") return answer_with(page_.style, "text/css; charset=utf-8");
  if (path == "favicon.ico") return answer_of_text(204, "");
  if (path == "scene.json") return answer_with(list_, kJson);
  std::string_view rest = path;
  const std::string_view kind = take_until('/', rest);
  const std::string_view id = take_until('/', rest);
  if (path == fmt::format("map/{}/cells", id) || path == fmt::format("map/{}/free", id)) {
    const SceneMap* const map = find_item(scene_.maps, id);
    if (map == nullptr) return not_found();
    return answer_of(rest == "cells" ? cells_bytes(map->map) : free_bytes(map->map));
  }
  if (path == fmt::format("path/{}", id)) {
    const ScenePath* const found = find_item(scene_.paths, id);
    return found != nullptr ? answer_of(path_bytes(*found, origin_m_), kBinary) : not_found();
  }
  if (path == fmt::format("points/{}", id)) {
    const ScenePoints* const found = find_item(scene_.points, id);
    return found != nullptr ? answer_of(points_bytes(*found, origin_m_), kBinary) : not_found();
  }
  const SceneLog* const log = kind == "log" ? find_item(scene_.logs, id) : nullptr;
  if (log != nullptr && path == fmt::format("log/{}", id)) return answer_of(beams_bytes(*log), kBinary);
  if (log != nullptr && path == fmt::format("log/{}/bins", id)) return bins_of(*log, query);
  return not_found();
}

Answer Answers::bins_of(const SceneLog& log, std::string_view query) const {
  BeamRange range{.from = 0, .to = log.beams.size()};
  if (!query.empty()) range = range_of(query);
  if (range.from > range.to || range.to > log.beams.size()) {
    return answer_of_text(400, "from and to must be numbers of beams\n");
  }
  Answer answer;
  answer.type = kBinary;
  answer.body = std::span(log.intensities).subspan(range.from * log.bins, (range.to - range.from) * log.bins);
  return answer;
}

}  // namespace pingvox::web
