# Compiles each public header alone, and twice in a row: it must bring what it uses, and a guard. One that has a guard
# and that its own source includes first is compiled alone there, unless headers are precompiled.
function(pingvox_is_compiled_alone header result)
  set(${result} OFF PARENT_SCOPE)
  string(REGEX REPLACE "^pingvox/(.*)\\.hpp$" "${PROJECT_SOURCE_DIR}/src/\\1.cpp" source "${header}")
  if(PINGVOX_PRECOMPILE OR NOT EXISTS "${source}")
    return()
  endif()
  file(STRINGS "${source}" included REGEX "^#include" LIMIT_COUNT 1)
  file(STRINGS "${PROJECT_SOURCE_DIR}/include/${header}" guard REGEX "^#pragma once$" LIMIT_COUNT 1)
  if(guard AND included STREQUAL "#include \"${header}\"")
    set(${result} ON PARENT_SCOPE)
  endif()
endfunction()

file(GLOB_RECURSE public_headers CONFIGURE_DEPENDS RELATIVE "${PROJECT_SOURCE_DIR}/include"
     "${PROJECT_SOURCE_DIR}/include/pingvox/*.hpp")
set(header_sources "")
foreach(header IN LISTS public_headers)
  pingvox_is_compiled_alone(${header} compiled_alone)
  if(compiled_alone)
    continue()
  endif()
  string(REGEX REPLACE "\\.hpp$" ".cpp" source "${PROJECT_BINARY_DIR}/headers/${header}")
  file(CONFIGURE OUTPUT "${source}" CONTENT "#include \"${header}\"\n#include \"${header}\"\n")
  list(APPEND header_sources "${source}")
endforeach()

add_library(pingvox_headers OBJECT ${header_sources})
pingvox_compile_options(pingvox_headers)
target_link_libraries(pingvox_headers PRIVATE pingvox::pingvox)
# There is nothing in them to optimise, nor for clang-tidy to find that the sources do not show it.
target_compile_options(pingvox_headers PRIVATE -O0)
set_target_properties(pingvox_headers PROPERTIES CXX_CLANG_TIDY "")
