# The one place that says how our targets are compiled.

# pingvox_compile_options(TARGET): language level, warnings and sanitizers.
function(pingvox_compile_options target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
  target_compile_options(
    ${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wnon-virtual-dtor -Wold-style-cast
                      -Woverloaded-virtual $<$<BOOL:${PINGVOX_WARNINGS_AS_ERRORS}>:-Werror>)
  if(PINGVOX_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${PINGVOX_SANITIZE} -fno-omit-frame-pointer
                                             -fno-sanitize-recover=all)
    target_compile_definitions(${target} PRIVATE _GLIBCXX_ASSERTIONS)
    target_link_options(${target} PUBLIC -fsanitize=${PINGVOX_SANITIZE})
  endif()
endfunction()

# pingvox_layer(NAME [DEPENDS LAYER...]): one folder of src/ and include/pingvox/ as one target.
function(pingvox_layer name)
  cmake_parse_arguments(LAYER "" "" "DEPENDS" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/src/${name}/*.cpp")
  list(TRANSFORM LAYER_DEPENDS PREPEND pingvox_)
  if(sources)
    add_library(pingvox_${name} STATIC ${sources})
    pingvox_compile_options(pingvox_${name})
    set_target_properties(pingvox_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    target_include_directories(pingvox_${name} PRIVATE "${PROJECT_SOURCE_DIR}/src")
    set(scope PUBLIC)
  else()
    add_library(pingvox_${name} INTERFACE)
    set(scope INTERFACE)
  endif()
  add_library(pingvox::${name} ALIAS pingvox_${name})
  target_include_directories(pingvox_${name} ${scope} $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                                             $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(pingvox_${name} ${scope} ${LAYER_DEPENDS})
endfunction()
