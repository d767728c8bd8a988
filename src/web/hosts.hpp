#pragma once

#include <string_view>

#include "pingvox/web/answer.hpp"

namespace pingvox::web {

/// Whether a Host header, "localhost:8080", names this server. After DNS rebinding it names the foreign page.
bool is_own_host(std::string_view host, const Access& access);

/// The port of a Host header, 80 where it names none; -1: invalid.
int port_of_host(std::string_view host);

}  // namespace pingvox::web
