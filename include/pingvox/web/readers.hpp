#pragma once

namespace pingvox::web {

/// Who may read what a server offers to other machines.
enum class Readers {
  kWithToken,  ///< those who have the address with its token
  /// Everybody in the networks of this machine, without a token: for an extension of BlueOS. Other pages may show the
  /// page in a frame, and the vehicle's proxy may reach it.
  kLocalNetwork,
};

}  // namespace pingvox::web
