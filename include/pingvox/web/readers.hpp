#pragma once

namespace pingvox::web {

/// Whom a server answers at addresses that other machines reach.
enum class Readers {
  kWithToken,  ///< those who have the address with its token
  /// Everybody in the networks of this machine, without a token: as an extension of BlueOS, where nothing has one. The
  /// page may be shown in frames of other pages, and is reached by the proxy of the vehicle as well.
  kLocalNetwork,
};

}  // namespace pingvox::web
