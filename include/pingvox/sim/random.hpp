#pragma once

#include "pingvox/geometry/random.hpp"  // where it is now
