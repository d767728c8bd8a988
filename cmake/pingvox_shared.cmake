# BUILD_SHARED_LIBS: one library libpingvox.so of all layers. The program, the tests and the Python module still contain
# the layers, as they use headers of `internal` folders, which are no part of what a library of a version promises.
option(BUILD_SHARED_LIBS "Build libpingvox.so, too; the layers are static libraries in any case" OFF)

# Raised by each release whose library breaks programs that are linked with the one before; it names the package of the
# library (packaging/debian), too.
set(PINGVOX_SOVERSION 0)

if(BUILD_SHARED_LIBS)
  foreach(layer IN LISTS PINGVOX_LAYERS)
    get_target_property(type ${layer} TYPE)
    if(type STREQUAL STATIC_LIBRARY)
      list(APPEND archives $<TARGET_FILE:${layer}>)
    endif()
  endforeach()

  set(exports "${PROJECT_SOURCE_DIR}/cmake/libpingvox.map")
  # It compiles nothing: all objects are the layers'.
  add_library(pingvox_shared SHARED "${exports}")
  set_target_properties(
    pingvox_shared
    PROPERTIES OUTPUT_NAME pingvox
               EXPORT_NAME pingvox
               VERSION "${PROJECT_VERSION}"
               SOVERSION "${PINGVOX_SOVERSION}"
               LINKER_LANGUAGE CXX
               LINK_DEPENDS "${exports}")
  # As options, not by $<LINK_LIBRARY:WHOLE_ARCHIVE,...>: CMake 3.25 names layers that others are linked with twice. They
  # are named again with the libraries that they need, which adds nothing.
  target_link_options(pingvox_shared PRIVATE LINKER:--whole-archive ${archives} LINKER:--no-whole-archive
                      "LINKER:--version-script=${exports}" LINKER:--no-undefined)
  target_link_libraries(pingvox_shared PRIVATE ${PINGVOX_LAYERS})
  target_include_directories(pingvox_shared INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                                                      $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(pingvox_shared INTERFACE cxx_std_20)
  # Of the public headers.
  target_link_libraries(pingvox_shared INTERFACE fmt::fmt tl::expected Eigen3::Eigen)
endif()
