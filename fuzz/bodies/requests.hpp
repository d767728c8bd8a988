#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "fuzz/bodies/require.hpp"
#include "pingvox/web/answer.hpp"
#include "web/live_controls.hpp"

namespace pingvox::fuzz {

/// A request as text: "METHOD TARGET", then a header a line.
inline web::Request request_from(std::string_view text) {
  const auto take_line = [&text] {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
    return line;
  };
  const std::string_view first = take_line();
  const std::size_t blank = first.find(' ');
  web::Request request{.method = std::string(first.substr(0, blank)), .target = {}};
  if (blank != std::string_view::npos) request.target = first.substr(blank + 1);
  while (!text.empty()) {
    const std::string_view line = take_line();
    const std::size_t colon = line.find(": ");
    if (colon == std::string_view::npos) continue;
    const std::string_view name = line.substr(0, colon);
    const std::string value(line.substr(colon + 2));
    if (name == "Host") request.host = value;
    if (name == "Origin") request.origin = value;
    if (name == "Sec-Fetch-Site") request.fetch_site = value;
    if (name == "Sec-Fetch-Mode") request.fetch_mode = value;
    if (name == "Sec-Fetch-Dest") request.fetch_dest = value;
  }
  return request;
}

/// A map of one cell, a path and a log of two beams.
inline web::Scene small_scene() {
  web::Scene scene;
  scene.title = "fuzzed";
  OccupancyMap map;
  map.edit().update(Key{32768, 32768, 32768}, LogOdds::from_probability(0.9));
  scene.maps.push_back({"map.bt", "bt", std::move(map)});
  scene.paths.push_back({"path.tum", Trajectory::still(Pose::Identity())});
  scene.points.push_back({"cloud.ply", {Eigen::Vector3d(1.0, 2.0, 3.0)}});
  web::SceneLog log;
  log.name = "log.csv";
  log.beams = {{.bin_length_m = 0.1}, {.bin_length_m = 0.1}};
  log.bins = 3;
  log.intensities = {1, 2, 3, 4, 5, 6};
  scene.logs.push_back(std::move(log));
  return scene;
}

/// What a page may ask of a run: only with the token, by its own origin, and in finite numbers.
/// @return whether it is a control
inline bool controls(const web::Request& request, const web::Access& access) {
  const auto asked = web::check_request(request, access);
  if (!asked) {
    require(asked.error().status >= 400 && asked.error().body.size() < 200, "a refusal is short");
    return false;
  }
  const bool has_token = !access.token.empty() && request.target.starts_with("/" + access.token + "/");
  require(asked->may_control == (has_token || access.readers == web::Readers::kLocalNetwork),
          "the token decides who controls");
  const bool is_of_page = !request.origin || request.origin->ends_with("://" + *request.host);
  require(is_of_page || asked->path.empty(), "a foreign origin controls nothing");
  const std::optional<web::LiveControl> control = web::control_of(asked->path, asked->query);
  if (!control) return false;
  require(asked->path.starts_with("control/"), "only these paths control");
  if (const auto* const head = std::get_if<web::live_control::DriveHead>(&*control)) {
    const auto is_finite = [](std::optional<double> number) { return !number || std::isfinite(*number); };
    require(is_finite(head->range_m) && is_finite(head->step_deg), "numbers are finite");
    if (head->sector_deg)
      require(is_finite((*head->sector_deg)[0]) && is_finite((*head->sector_deg)[1]), "as are angles");
  }
  return true;
}

/// Any bytes as a request: only what is in the table is told, and only to those who may have it.
/// @return bytes of the scene or the page that were told
inline std::size_t requests(std::span<const std::uint8_t> bytes) {
  const web::Request request = request_from(std::string(bytes.begin(), bytes.end()));
  const web::Answers answers(small_scene(), {"<html>", "script", "style"});
  const web::Access open{.port = 8080, .hosts = {"localhost", "127.0.0.1"}};
  const web::Answer answer = answers.answer(request, open);
  constexpr int kStatuses[] = {200, 204, 400, 403, 404, 405, 414};
  bool is_known = false;
  for (const int status : kStatuses) is_known = is_known || status == answer.status;
  require(is_known, "the status is one of those that are documented");
  const bool is_told = answer.status == 200;
  if (is_told) {
    require(request.method == "GET", "only GET is answered");
    require(request.host == "localhost:8080" || request.host == "127.0.0.1:8080", "a foreign host is told nothing");
    require(!request.origin || *request.origin == "http://" + *request.host, "a foreign origin is told nothing");
    require(request.fetch_site != "cross-site" || request.target.substr(0, request.target.find('?')) == "/",
            "of pages of other sites only links are answered");
    require(request.target.find("..") == std::string::npos || request.target.starts_with("/?") ||
                request.target.find('?') < request.target.find(".."),
            "no path leads out");
  } else {
    require(answer.body.size() < 200, "a refusal is short");
  }
  web::Access with_token = open;
  with_token.token = "0123456789abcdef";
  const web::Answer told = answers.answer(request, with_token);
  require(told.status != 200 || request.target.starts_with("/0123456789abcdef/"), "without the token nothing is told");
  const web::Access vehicle{.port = 8080, .hosts = {"localhost"}, .readers = web::Readers::kLocalNetwork};
  const web::Answer shared = answers.answer(request, vehicle);
  if (shared.status == 200 && request.target.starts_with("/scene.json")) {
    require(!request.origin || request.origin->ends_with("://" + *request.host), "a foreign origin is told nothing");
    require(!request.host->ends_with(".example"), "a foreign host is told nothing");
  }
  controls(request, open);
  controls(request, with_token);
  controls(request, vehicle);
  return is_told ? answer.body.size() : 0;
}

}  // namespace pingvox::fuzz
