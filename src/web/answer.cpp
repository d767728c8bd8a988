#include "pingvox/web/answer.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <system_error>

#include "web/hosts.hpp"
#include "web/take_until.hpp"

namespace pingvox::web {
namespace {

Answer answer_with(std::string_view part, std::string_view type) {
  return answer_of(Bytes(part.begin(), part.end()), type);
}

/// A number in digits alone.
std::optional<std::size_t> number_of(std::string_view text) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_digits = std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
  if (text.empty() || !is_digits || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

/// Whether the request comes from a page of another origin. Links to the page are always allowed, frames with it where
/// the server allows them.
bool is_foreign(const Request& request, bool is_page, const Access& access) {
  const bool is_local = access.readers == Readers::kLocalNetwork;
  const bool is_own_origin = !request.origin || *request.origin == "http://" + *request.host ||
                             (is_local && *request.origin == "https://" + *request.host);
  if (!is_own_origin) return true;
  if (!request.fetch_site || *request.fetch_site == "same-origin" || *request.fetch_site == "none") return false;
  const bool is_shown = request.fetch_dest == "document" || (is_local && request.fetch_dest == "iframe");
  return !is_page || request.fetch_mode != "navigate" || !is_shown;
}

/// The item that the id in a path names; nullptr: there is none.
template <class Item>
const Item* find_item(const std::vector<Item>& items, std::string_view id) {
  const std::optional<std::size_t> number = number_of(id);
  const bool is_plain = id.size() == 1 || !id.starts_with('0');
  return number && is_plain && *number < items.size() ? &items[*number] : nullptr;
}

}  // namespace

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

Answer not_found() {
  return answer_of_text(404, "not found\n");
}

Answer answer_of(Result<Bytes> bytes) {
  if (bytes) return answer_of(*std::move(bytes), kBinaryType);
  return answer_of_text(500, bytes.error().message + "\n");
}

std::optional<std::size_t> number_of_query(std::string_view name, std::string_view query) {
  if (!query.starts_with(name) || !query.substr(name.size()).starts_with('=')) return std::nullopt;
  return number_of(query.substr(name.size() + 1));
}

std::optional<NumberRange> range_of(std::string_view query) {
  const std::string_view first = take_until('&', query);
  const auto from = number_of_query("from", first), to = number_of_query("to", query);
  return from && to ? std::optional(NumberRange{*from, *to}) : std::nullopt;
}

std::span<const Header> fixed_headers(Readers readers) {
  static constexpr std::string_view kUnframed =
      "default-src 'none'; script-src 'self'; worker-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
      "connect-src 'self'; "
      "base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
  static constexpr std::string_view kFramed = kUnframed.substr(0, kUnframed.rfind("; "));
  static constexpr std::array kWithToken = {
      Header{"Content-Security-Policy", kUnframed}, Header{"Cross-Origin-Resource-Policy", "same-origin"},
      Header{"X-Content-Type-Options", "nosniff"},  Header{"Cache-Control", "no-store"},
      Header{"Referrer-Policy", "no-referrer"},
  };
  // Other pages may show the page and its icon.
  static constexpr std::array kLocalNetwork = {Header{"Content-Security-Policy", kFramed}, kWithToken[2], kWithToken[3],
                                               kWithToken[4]};
  if (readers == Readers::kLocalNetwork) return kLocalNetwork;
  return kWithToken;
}

bool is_same_secret(std::string_view given, std::string_view wanted) {
  unsigned different = given.size() == wanted.size() ? 0 : 1;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const char c = given.empty() ? '\0' : given[std::min(i, given.size() - 1)];
    different |= static_cast<unsigned char>(c) ^ static_cast<unsigned char>(wanted[i]);
  }
  return different == 0;
}

tl::expected<Asked, Answer> check_request(const Request& request, const Access& access) {
  constexpr std::size_t kLongestTarget = 256;
  const auto refuse = [](int status, std::string_view text) { return tl::unexpected(answer_of_text(status, text)); };
  if (request.target.size() > kLongestTarget) return refuse(414, "the path is too long\n");
  if (!request.host) return refuse(400, "the request needs exactly one Host header\n");
  if (!is_own_host(*request.host, access)) {
    return refuse(403, "wrong host: use the address printed on the terminal\n");
  }
  std::string_view query = request.target;
  std::string_view path = take_until('?', query);
  if (!path.starts_with('/')) return tl::unexpected(not_found());
  path.remove_prefix(1);
  bool has_token = false;
  if (!access.token.empty()) {
    std::string_view rest = path;
    has_token = is_same_secret(take_until('/', rest), access.token);
    // Without the slash behind it the page would not find its parts.
    const bool is_complete = has_token && path.size() > access.token.size();
    if (!is_complete && (has_token || !access.is_open)) {
      return refuse(403, "the token is missing or wrong: copy the whole address from the terminal\n");
    }
    if (has_token) path = rest;
  }
  if (is_foreign(request, path.empty(), access)) return refuse(403, "requests from other pages are refused\n");
  return Asked{request.method, path, query, has_token || access.readers == Readers::kLocalNetwork};
}

std::optional<Answer> page_answer(const Page& page, std::string_view path) {
  if (path.empty()) return answer_with(page.html, "text/html; charset=utf-8");
  if (path == "page.js") return answer_with(page.script, "text/javascript; charset=utf-8");
  if (path == "page.css") return answer_with(page.style, "text/css; charset=utf-8");
  if (path == "favicon.ico") return answer_of_text(204, "");
  return std::nullopt;
}

Answer Answers::answer(const Request& request, const Access& access) const {
  const tl::expected<Asked, Answer> asked = check_request(request, access);
  if (!asked) return asked.error();
  if (asked->method != "GET") return answer_of_text(405, "only GET is allowed\n");
  return content_of(asked->path, asked->query);
}

Answer Answers::content_of(std::string_view path, std::string_view query) const {
  if (std::optional<Answer> part = page_answer(page_, path)) return *std::move(part);
  if (path == "scene.json") return answer_with(list_, kJsonType);
  std::string_view rest = path;
  const std::string_view kind = take_until('/', rest);
  const std::string_view id = take_until('/', rest);
  if (path == fmt::format("map/{}/cells", id) || path == fmt::format("map/{}/free", id)) {
    const SceneMap* const map = find_item(scene_.maps, id);
    if (map == nullptr) return not_found();
    return answer_of(rest == "cells" ? cells_bytes(map->map) : free_bytes(map->map));
  }
  if (path == fmt::format("map/{}/agreement", id)) {
    const SceneMap* const map = find_item(scene_.maps, id);
    return map != nullptr && !map->agreement.empty() ? answer_of(agreement_bytes(*map)) : not_found();
  }
  if (path == fmt::format("path/{}", id)) {
    const ScenePath* const found = find_item(scene_.paths, id);
    return found != nullptr ? answer_of(path_bytes(*found, origin_m_), kBinaryType) : not_found();
  }
  if (path == fmt::format("points/{}", id)) {
    const ScenePoints* const found = find_item(scene_.points, id);
    return found != nullptr ? answer_of(points_bytes(*found, origin_m_), kBinaryType) : not_found();
  }
  const SceneLog* const log = kind == "log" ? find_item(scene_.logs, id) : nullptr;
  if (log != nullptr && path == fmt::format("log/{}", id)) return answer_of(beams_bytes(*log), kBinaryType);
  if (log != nullptr && path == fmt::format("log/{}/bins", id)) return bins_of(*log, query);
  return not_found();
}

Answer Answers::bins_of(const SceneLog& log, std::string_view query) const {
  const std::optional<NumberRange> asked = query.empty() ? NumberRange{0, log.beams.size()} : range_of(query);
  const NumberRange range = asked.value_or(NumberRange{1, 0});
  if (range.from > range.to || range.to > log.beams.size()) {
    return answer_of_text(400, "from and to must be numbers of beams\n");
  }
  Answer answer;
  answer.type = kBinaryType;
  answer.body = std::span(log.intensities).subspan(range.from * log.bins, (range.to - range.from) * log.bins);
  return answer;
}

}  // namespace pingvox::web
