#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pingvox/web/page.hpp"
#include "pingvox/web/readers.hpp"
#include "pingvox/web/scene.hpp"
#include "pingvox/web/scene_bytes.hpp"

namespace pingvox::web {

/// The parts of a request that its answer depends on.
struct Request {
  std::string method;  ///< "GET"
  std::string target;  ///< path and query as they were sent: "/log/0/bins?from=0&to=9"
  /// Headers; nullopt: not sent, or more than once.
  std::optional<std::string> host = {}, origin = {}, fetch_site = {}, fetch_mode = {}, fetch_dest = {};
};

using Header = std::pair<std::string_view, std::string_view>;
/// Headers of each answer: no caching, no sniffing of types, no access from other origins, no script but the page's
/// own, frames only for Readers::kLocalNetwork.
std::span<const Header> fixed_headers(Readers readers = Readers::kWithToken);

struct Answer {
  int status = 200;
  std::string_view type = "text/plain; charset=utf-8";
  std::span<const Header> headers = {};     ///< besides the fixed ones
  std::span<const std::uint8_t> body = {};  ///< of the scene or the page, or of `owned`
  std::shared_ptr<const Bytes> owned = {};
  /// Of a streamed answer, in place of the body: the next chunk, after at most half a second; nullopt at the end.
  std::function<std::optional<std::string>()> next = {};
};

inline constexpr std::string_view kBinaryType = "application/octet-stream",
                                  kJsonType = "application/json; charset=utf-8";
Answer answer_of(Bytes bytes, std::string_view type);
Answer answer_of(Result<Bytes> bytes);  ///< 500 with the error
Answer answer_of_text(int status, std::string_view text);
Answer not_found();

/// Which requests a server accepts.
struct Access {
  int port = 0;
  /// Accepted hosts, as in "localhost", "127.0.0.1" or "[::1]". Others may come from foreign pages (DNS rebinding).
  std::vector<std::string> hosts = {};
  bool any_address = false;  ///< whether any numeric address is accepted
  std::string token = {};    ///< first part of each path; empty: none
  /// kLocalNetwork: hosts may also be private addresses and names of local networks, with any port.
  Readers readers = Readers::kWithToken;
  bool is_open = false;  ///< whether paths without the token are also answered
};

/// Answers requests, from many threads at once.
using Responder = std::function<Answer(const Request&, const Access&)>;

/// An accepted request.
struct Asked {
  std::string_view method, path, query;  ///< of the request; the path without its token
  bool may_control = false;              ///< it has the token, or comes from a network whose readers need none
};
/// @return otherwise the error answer: 400 and 403 for requests from a page of another origin, or with a wrong host or
///         token; 404 and 414 for bad paths
tl::expected<Asked, Answer> check_request(const Request& request, const Access& access);

/// Numbers of beams or poses: [from, to).
struct NumberRange {
  std::size_t from = 0, to = 0;
};
/// Of "from=2&to=9"; nullopt: not of this form.
std::optional<NumberRange> range_of(std::string_view query);
/// 7 of "since=7" for the name "since"; nullopt: not of this form.
std::optional<std::size_t> number_of_query(std::string_view name, std::string_view query);

/// Page, script or style; nullopt: not the path of one.
std::optional<Answer> page_answer(const Page& page, std::string_view path);

/// Answers requests for a page and its scene: GET for a fixed table of paths. Const functions may run in many threads.
class Answers {
 public:
  /// @param page  has to outlive it
  Answers(Scene scene, Page page)
      : scene_(std::move(scene)), page_(page), list_(scene_json(scene_)), origin_m_(scene_.origin_m()) {}

  const Scene& scene() const { return scene_; }

  /// Status 200; 204 for an icon; 400 and 403 for requests from a page of another origin, or with a wrong host; 404,
  /// 405 and 414; 500 where the scene cannot be sent.
  Answer answer(const Request& request, const Access& access) const;

 private:
  Answer content_of(std::string_view path, std::string_view query) const;
  Answer bins_of(const SceneLog& log, std::string_view query) const;

  Scene scene_;
  Page page_;
  std::string list_;  ///< scene.json
  Eigen::Vector3d origin_m_;
};

/// Compares two texts in a time that depends only on the length of `wanted`.
bool is_same_secret(std::string_view given, std::string_view wanted);

}  // namespace pingvox::web
