#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pingvox/web/page.hpp"
#include "pingvox/web/scene.hpp"
#include "pingvox/web/scene_bytes.hpp"

namespace pingvox::web {

/// What of a request decides about its answer.
struct Request {
  std::string method;  ///< "GET"
  std::string target;  ///< path and query as they were sent: "/log/0/bins?from=0&to=9"
  /// Headers; nullopt: not sent, or more than once.
  std::optional<std::string> host = {}, origin = {}, fetch_site = {}, fetch_mode = {}, fetch_dest = {};
};

using Header = std::pair<std::string_view, std::string_view>;
/// Headers of each answer: nothing is stored, guessed, framed or read by pages of other origins, and the page runs no
/// script but its own.
std::span<const Header> fixed_headers();

struct Answer {
  int status = 200;
  std::string_view type = "text/plain; charset=utf-8";
  std::span<const std::uint8_t> body = {};  ///< of the scene or the page, or of `owned`
  std::shared_ptr<const Bytes> owned = {};
};

/// Whom a server answers.
struct Access {
  int port = 0;
  /// Names and addresses by which it is reached, as in "localhost", "127.0.0.1" or "[::1]". Other names are those of
  /// foreign pages (DNS rebinding).
  std::vector<std::string> hosts = {};
  bool any_address = false;  ///< whether any numerical address will do
  std::string token = {};    ///< first part of each path; empty: none
};

/// Answers requests for a page and its scene: GET for a fixed table of paths. Const functions may run in many threads.
class Answers {
 public:
  /// @param page  has to outlive it
  Answers(Scene scene, Page page)
      : scene_(std::move(scene)), page_(page), list_(scene_json(scene_)), origin_m_(scene_.origin_m()) {}

  const Scene& scene() const { return scene_; }

  /// The status is 200; 204 for an icon; 400 and 403 for requests that a page of another origin made, or whose host is
  /// wrong; 404, 405 and 414; 500 where the scene cannot be sent.
  Answer answer(const Request& request, const Access& access) const;

 private:
  Answer content_of(std::string_view path, std::string_view query) const;
  Answer bins_of(const SceneLog& log, std::string_view query) const;

  Scene scene_;
  Page page_;
  std::string list_;  ///< scene.json
  Eigen::Vector3d origin_m_;
};

/// Whether two texts are the same, in a time that depends on the length of `wanted` alone.
bool is_same_secret(std::string_view given, std::string_view wanted);

}  // namespace pingvox::web
