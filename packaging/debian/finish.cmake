# Run by cpack on the files of all packages before it packs them: adds what Debian asks for, compresses manual pages and
# strips programs and libraries. The folder of each component is in CPACK_TEMPORARY_DIRECTORY.
cmake_minimum_required(VERSION 3.25)

# -n: the same file packed tomorrow has the same bytes.
macro(pack file)
  execute_process(COMMAND gzip -9nf "${file}" COMMAND_ERROR_IS_FATAL ANY)
endmacro()

# strip(OPTIONS PATTERN...): what linking and running do not need, as dh_strip does.
function(strip options)
  file(GLOB_RECURSE files LIST_DIRECTORIES OFF ${ARGN})
  foreach(file IN LISTS files)
    if(NOT IS_SYMLINK "${file}")
      execute_process(COMMAND "${CPACK_PINGVOX_STRIP}" ${options} --remove-section=.comment --remove-section=.note "${file}"
                              COMMAND_ERROR_IS_FATAL ANY)
    endif()
  endforeach()
endfunction()

foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  set(root "${CPACK_TEMPORARY_DIRECTORY}/${component}")
  string(TOUPPER ${component} key)
  set(package "${CPACK_DEBIAN_${key}_PACKAGE_NAME}")

  set(documents "${root}${CPACK_PACKAGING_INSTALL_PREFIX}/${CPACK_PINGVOX_DOC_DIR}/${package}")
  file(MAKE_DIRECTORY "${documents}")
  file(COPY_FILE "${CPACK_PINGVOX_PACKAGES_DIR}/copyright" "${documents}/copyright")
  file(COPY_FILE "${CPACK_PINGVOX_PACKAGES_DIR}/changelog" "${documents}/changelog.Debian")
  file(COPY_FILE "${CPACK_PINGVOX_PACKAGES_DIR}/../../CHANGELOG.md" "${documents}/changelog")
  pack("${documents}/changelog.Debian")
  pack("${documents}/changelog")

  set(overrides "${CPACK_PINGVOX_PACKAGES_DIR}/${component}.lintian-overrides")
  if(EXISTS "${overrides}")
    set(folder "${root}${CPACK_PACKAGING_INSTALL_PREFIX}/share/lintian/overrides")
    file(MAKE_DIRECTORY "${folder}")
    file(READ "${overrides}" text)
    file(WRITE "${folder}/${package}" "${text}")
  endif()

  file(GLOB_RECURSE pages "${root}${CPACK_PACKAGING_INSTALL_PREFIX}/${CPACK_PINGVOX_MAN_DIR}/*.[1-9]")
  foreach(page IN LISTS pages)
    pack("${page}")
  endforeach()

  strip(--strip-unneeded "${root}/*/bin/*" "${root}/*.so" "${root}/*.so.*")
  strip("--strip-debug;--enable-deterministic-archives" "${root}/*.a")
endforeach()
