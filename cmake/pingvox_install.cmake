# What `cmake --install` puts where, so that find_package(pingvox) finds it.
include(CMakePackageConfigHelpers)

set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/pingvox")

install(TARGETS pingvox_all ${PINGVOX_LAYERS} EXPORT pingvox)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/include/pingvox" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}"
        FILES_MATCHING PATTERN "*.hpp")
install(EXPORT pingvox FILE pingvoxTargets.cmake NAMESPACE pingvox:: DESTINATION "${package_dir}")

configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/pingvoxConfig.cmake.in"
                              "${PROJECT_BINARY_DIR}/pingvoxConfig.cmake" INSTALL_DESTINATION "${package_dir}")
# Before 1.0 a minor version may break its callers.
write_basic_package_version_file("${PROJECT_BINARY_DIR}/pingvoxConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/pingvoxConfig.cmake" "${PROJECT_BINARY_DIR}/pingvoxConfigVersion.cmake"
        DESTINATION "${package_dir}")

install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}")
if(PINGVOX_BUILD_APP)
  # Installed under the program's name, by which bash-completion loads it.
  install(FILES "${PROJECT_SOURCE_DIR}/completions/pingvox.bash" RENAME pingvox
          DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions")
  if(EXISTS "${PROJECT_SOURCE_DIR}/docs/man/pingvox.1")
    install(FILES "${PROJECT_SOURCE_DIR}/docs/man/pingvox.1" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1")
  endif()
endif()
