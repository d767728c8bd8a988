# What `cmake --install` puts where, so that find_package(pingvox) and pkg-config find it. The components are packages of
# their own (cmake/pingvox_package.cmake).
include(CMakePackageConfigHelpers)

set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/pingvox")

set(library_components RUNTIME COMPONENT library LIBRARY COMPONENT library NAMELINK_COMPONENT development
                       ARCHIVE COMPONENT development)
install(TARGETS pingvox_all ${PINGVOX_LAYERS} EXPORT pingvox_static ${library_components})
install(EXPORT pingvox_static FILE pingvoxStaticTargets.cmake NAMESPACE pingvox:: DESTINATION "${package_dir}"
        COMPONENT development)
if(BUILD_SHARED_LIBS)
  install(TARGETS pingvox_shared EXPORT pingvox_shared ${library_components})
  install(EXPORT pingvox_shared FILE pingvoxSharedTargets.cmake NAMESPACE pingvox:: DESTINATION "${package_dir}"
          COMPONENT development)

  # So that the folder can be moved, as find_package can.
  file(RELATIVE_PATH PINGVOX_PREFIX_OF_PC "${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig" "${CMAKE_INSTALL_PREFIX}")
  string(REGEX REPLACE "/$" "" PINGVOX_PREFIX_OF_PC "${PINGVOX_PREFIX_OF_PC}")
  configure_file("${PROJECT_SOURCE_DIR}/cmake/pingvox.pc.in" "${PROJECT_BINARY_DIR}/pingvox.pc" @ONLY)
  install(FILES "${PROJECT_BINARY_DIR}/pingvox.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig"
          COMPONENT development)
endif()
install(DIRECTORY "${PROJECT_SOURCE_DIR}/include/pingvox" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}"
        COMPONENT development FILES_MATCHING PATTERN "*.hpp")

string(REPLACE "pingvox_" "" PINGVOX_LAYER_NAMES "${PINGVOX_LAYERS}")
string(REPLACE ";" " " PINGVOX_LAYER_NAMES "${PINGVOX_LAYER_NAMES}")
configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/pingvoxConfig.cmake.in"
                              "${PROJECT_BINARY_DIR}/pingvoxConfig.cmake" INSTALL_DESTINATION "${package_dir}")
# Before 1.0 a minor version may break its callers.
write_basic_package_version_file("${PROJECT_BINARY_DIR}/pingvoxConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/pingvoxConfig.cmake" "${PROJECT_BINARY_DIR}/pingvoxConfigVersion.cmake"
        DESTINATION "${package_dir}" COMPONENT development)

# Packages of Debian have a file of their own for it.
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT licence)
if(PINGVOX_BUILD_APP)
  # Installed under the program's name, by which bash-completion loads it.
  install(FILES "${PROJECT_SOURCE_DIR}/completions/pingvox.bash" RENAME pingvox
          DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions" COMPONENT program)
  if(EXISTS "${PROJECT_SOURCE_DIR}/docs/man/pingvox.1")
    install(FILES "${PROJECT_SOURCE_DIR}/docs/man/pingvox.1" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1"
            COMPONENT program)
  endif()
endif()
