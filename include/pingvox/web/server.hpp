#pragma once

#include <memory>
#include <string>

#include "pingvox/result.hpp"
#include "pingvox/web/answer.hpp"

namespace pingvox::web {

/// Which servers require a token.
enum class WantToken {
  kBeyondLoopback,  ///< those that other machines reach
  kForControl,      ///< all; at the loopback address reading needs none
};

struct ServerOptions {
  std::string address = "127.0.0.1";  ///< of this machine, or a name of it; others than loopback get a token
  int port = 0;                       ///< 0: any free port
  Readers readers = Readers::kWithToken;
  WantToken token = WantToken::kBeyondLoopback;
  double longest_request_s = 10.0;  ///< timeout for the arrival of a request

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// Serves a page over HTTP from threads of its own until it is destroyed. Requests that are long or slow are refused,
/// and clients that read too slowly are disconnected.
class Server {
 public:
  /// @return kBadOption when the options do not validate; kIo when the port cannot be opened; kUnsupported when the
  ///         library was built without a server (docs/view.md)
  static Result<Server> start(Answers answers, const ServerOptions& options = {});
  /// @param responder  called from several threads
  static Result<Server> start(Responder responder, const ServerOptions& options = {});
  Server(Server&&) noexcept;
  Server& operator=(Server&&) noexcept;
  ~Server();

  /// "http://127.0.0.1:40123/": what a browser opens, with the token if there is one.
  const std::string& url() const;

 private:
  struct Parts;
  explicit Server(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace pingvox::web
