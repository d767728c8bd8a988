#pragma once

#include <memory>
#include <string>

#include "pingvox/result.hpp"
#include "pingvox/web/answer.hpp"

namespace pingvox::web {

/// Which servers want a token.
enum class WantToken {
  kBeyondLoopback,  ///< those that other machines reach
  kForControl,      ///< all; at the loopback address what needs no token is answered without it, too
};

struct ServerOptions {
  std::string address = "127.0.0.1";  ///< of this machine, or a name of it; others than loopback get a token
  int port = 0;                       ///< 0: any that is free
  Readers readers = Readers::kWithToken;
  WantToken token = WantToken::kBeyondLoopback;
  double longest_request_s = 10.0;  ///< a request that has not arrived by then is given up

  Result<void> validate() const;  ///< kBadOption names every broken field at once
};

/// Serves a page over HTTP from threads of its own until it is destroyed. A request has to be short and
/// to arrive in time, and its answer has to be taken at some pace.
class Server {
 public:
  /// @return kBadOption when the options do not validate; kIo when the port cannot be had; kUnsupported when the
  /// library
  ///         was built without it (docs/view.md)
  static Result<Server> start(Answers answers, const ServerOptions& options = {});
  /// @param responder  is asked from several threads
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
