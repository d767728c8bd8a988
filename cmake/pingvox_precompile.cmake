# Headers of others, read once and not in each source: half of a full build otherwise. Only theirs, so that a change of
# ours compiles again what includes it and nothing else. Sources still include what they use: the preset `tidy` compiles
# each of library and program, and each public header, without.
set(PINGVOX_PRECOMPILED
    <algorithm> <array> <bit> <cassert> <cmath> <cstddef> <cstdint> <cstring> <filesystem> <functional> <limits> <memory>
    <new> <numbers> <optional> <ostream> <span> <string> <string_view> <utility> <variant> <vector> #
    <Eigen/Core> <Eigen/Geometry> <fmt/core.h> <fmt/format.h> <tl/expected.hpp>)

# clang forgets which lines of a precompiled libstdc++ may call what is deprecated (std::stable_sort does).
if(PINGVOX_PRECOMPILE AND CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  add_compile_options(-Wno-deprecated-declarations)
endif()

# pingvox_precompile(TARGET [HEADER...]): for a target that others may share.
function(pingvox_precompile target)
  if(PINGVOX_PRECOMPILE)
    target_precompile_headers(${target} PRIVATE ${PINGVOX_PRECOMPILED} ${ARGN})
  endif()
endfunction()

# pingvox_share_precompiled(TARGET OWNER): the owner's, which must be compiled alike.
function(pingvox_share_precompiled target owner)
  if(PINGVOX_PRECOMPILE)
    target_precompile_headers(${target} REUSE_FROM ${owner})
  endif()
endfunction()
