#pragma once

#include <string_view>

#include "pingvox/web/answer.hpp"

namespace pingvox::web {

/// Whether a Host header, "localhost:8080", names this server. A page of another origin whose name leads here names
/// itself.
bool is_own_host(std::string_view host, const Access& access);

/// The port of a Host header, 80 where it names none; -1: it is none.
int port_of_host(std::string_view host);

}  // namespace pingvox::web
