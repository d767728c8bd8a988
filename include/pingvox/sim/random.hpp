#pragma once

#include "pingvox/geometry/random.hpp"
