# The page of `pingvox view`: bundled by Debian's esbuild with Debian's three.js (web/bundle), and built into the layer `web` together
# with the server that shows it (Debian's cpp-httplib). Without them the layer has neither, and `view` says so.
set(PINGVOX_VIEW AUTO CACHE STRING "Build the page of `pingvox view` and its server: ON, OFF, or AUTO where possible")
set_property(CACHE PINGVOX_VIEW PROPERTY STRINGS AUTO ON OFF)

set(PINGVOX_HAS_VIEW FALSE)
if(PINGVOX_VIEW)
  find_program(PINGVOX_ESBUILD esbuild)
  find_file(PINGVOX_THREE_MODULE build/three.module.js PATHS /usr/share/javascript/three)
  find_path(PINGVOX_HTTPLIB_INCLUDE_DIR httplib.h)
  find_library(PINGVOX_HTTPLIB_LIBRARY cpp-httplib)
  mark_as_advanced(PINGVOX_ESBUILD PINGVOX_THREE_MODULE PINGVOX_HTTPLIB_INCLUDE_DIR PINGVOX_HTTPLIB_LIBRARY)
  find_package(PkgConfig QUIET)
  if(PKG_CONFIG_FOUND)
    # Says with which options Debian compiled the library: its classes differ by them.
    pkg_check_modules(PINGVOX_HTTPLIB QUIET cpp-httplib)
  endif()
  if(PINGVOX_ESBUILD
     AND PINGVOX_THREE_MODULE
     AND PINGVOX_HTTPLIB_INCLUDE_DIR
     AND PINGVOX_HTTPLIB_LIBRARY
     AND PINGVOX_HTTPLIB_FOUND)
    set(PINGVOX_HAS_VIEW TRUE)
    enable_language(ASM)
  elseif(PINGVOX_VIEW STREQUAL AUTO)
    message(STATUS "pingvox view has no page: `tools/packages view` installs what it is made of")
  else()
    message(FATAL_ERROR "PINGVOX_VIEW is ${PINGVOX_VIEW}, and something is missing: `tools/packages view` installs it")
  endif()
endif()

# pingvox_add_page(LAYER): builds page and server into it, where that is possible.
function(pingvox_add_page layer)
  if(NOT PINGVOX_HAS_VIEW)
    return()
  endif()
  set(sources "${PROJECT_SOURCE_DIR}/web")
  set(bundle "${PROJECT_BINARY_DIR}/page")
  file(GLOB_RECURSE parts CONFIGURE_DEPENDS "${sources}/src/*.ts")
  add_custom_command(
    OUTPUT "${bundle}/page.html" "${bundle}/page.js" "${bundle}/page.css"
    COMMAND "${CMAKE_COMMAND}" -E env "THREE=${PINGVOX_THREE_MODULE}" "${sources}/bundle" "${bundle}"
    DEPENDS ${parts} "${sources}/bundle" "${sources}/page.css" "${sources}/page.html"
    VERBATIM)

  # An assembler file takes the bytes as they are.
  set(assembler ".section .rodata\n")
  foreach(part IN ITEMS html js css)
    set(symbol pingvox_page_${part})
    string(APPEND assembler ".globl ${symbol}\n.globl ${symbol}_end\n" #
                            "${symbol}:\n.incbin \"${bundle}/page.${part}\"\n${symbol}_end:\n.byte 0\n")
  endforeach()
  file(CONFIGURE OUTPUT "${bundle}/page.s" CONTENT "${assembler}.section .note.GNU-stack,\"\",%progbits\n")
  set_source_files_properties(
    "${bundle}/page.s" PROPERTIES OBJECT_DEPENDS "${bundle}/page.html;${bundle}/page.js;${bundle}/page.css")
  add_library(${layer}_page OBJECT "${bundle}/page.s")
  set_target_properties(${layer}_page PROPERTIES POSITION_INDEPENDENT_CODE ON)
  # CMake asks for a list of dependencies, which clang does not make of assembler files.
  target_compile_options(${layer}_page PRIVATE $<$<CXX_COMPILER_ID:Clang>:-Wno-unused-command-line-argument>)
  target_sources(${layer} PRIVATE $<TARGET_OBJECTS:${layer}_page>)

  target_compile_definitions(${layer} PRIVATE PINGVOX_HAS_PAGE)
  set_source_files_properties("${PROJECT_SOURCE_DIR}/src/web/server.cpp"
                              PROPERTIES COMPILE_OPTIONS "${PINGVOX_HTTPLIB_CFLAGS_OTHER}" #
                                         SKIP_UNITY_BUILD_INCLUSION ON)
  # By name, not by path: an installed pingvox is linked with the library of the machine it is on.
  target_link_libraries(${layer} PRIVATE cpp-httplib Threads::Threads)
endfunction()
