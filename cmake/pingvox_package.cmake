# Packages for Debian by `cpack`, one of each component of the installation. The preset `debian` is what they are made of,
# and tools/release makes them.
set(packages_dir "${PROJECT_SOURCE_DIR}/packaging/debian")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME pingvox)
set(CPACK_PACKAGE_VENDOR "the pingvox developers")
set(CPACK_PACKAGE_CONTACT "the pingvox developers <pingvox@example.org>")
set(CPACK_PACKAGE_VERSION "${PROJECT_VERSION}")
# Each package has its own.
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")
set(CPACK_PACKAGING_INSTALL_PREFIX "${CMAKE_INSTALL_PREFIX}")
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_VERBATIM_VARIABLES ON)
# What Debian asks of the files of a package.
set(CPACK_PRE_BUILD_SCRIPTS "${packages_dir}/finish.cmake")
set(CPACK_PINGVOX_PACKAGES_DIR "${packages_dir}")
set(CPACK_PINGVOX_DOC_DIR "${CMAKE_INSTALL_DATADIR}/doc")
set(CPACK_PINGVOX_MAN_DIR "${CMAKE_INSTALL_MANDIR}")
set(CPACK_PINGVOX_STRIP "${CMAKE_STRIP}")

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
# The changelog says how often this version was packaged.
file(STRINGS "${packages_dir}/changelog" first_line LIMIT_COUNT 1)
string(REGEX REPLACE ".*-([^)]*)\\).*" "\\1" CPACK_DEBIAN_PACKAGE_RELEASE "${first_line}")
set(CPACK_DEBIAN_PACKAGE_SOURCE pingvox)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
if(CMAKE_SYSTEM_PROCESSOR STREQUAL aarch64)
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
endif()
set(version "${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}")

# pingvox_debian_package(COMPONENT NAME SECTION DESCRIPTION): its first line is the summary.
function(pingvox_debian_package component name section description)
  string(TOUPPER ${component} key)
  set(CPACK_COMPONENTS_ALL ${CPACK_COMPONENTS_ALL} ${component} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_DESCRIPTION "${description}" PARENT_SCOPE)
endfunction()

if(PINGVOX_BUILD_APP)
  pingvox_debian_package(
    program pingvox science
    "turn recordings of scanning sonars into 3D occupancy maps
Reads the logs of mechanically scanned sonars (Ping360, Micron, SeaNet
captures, ROS bags, MATLAB files, CSV) with the navigation of the vehicle,
detects the echoes and writes a 3D occupancy map that OctoMap's tools and
ROS open. It also estimates the path of the vehicle (SLAM), finds it in a
known map, maps while a sonar runs, and shows maps in a browser.")
  set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS xdg-utils)
  set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS octovis)
endif()
if(BUILD_SHARED_LIBS)
  set(of_library "Reads logs of scanning sonars and of navigation, detects echoes, estimates
the path of the vehicle, and builds, queries and writes 3D occupancy maps
equal to OctoMap's.")
  pingvox_debian_package(library libpingvox${PINGVOX_SOVERSION} libs
                         "3D occupancy maps of scanning sonars, shared library\n${of_library}")
  # Programs that are linked with it need a version that has what they use.
  file(CONFIGURE OUTPUT "${PROJECT_BINARY_DIR}/debian/library/shlibs"
       CONTENT "libpingvox ${PINGVOX_SOVERSION} libpingvox${PINGVOX_SOVERSION} (>= ${version})\n")
  set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA "${PROJECT_BINARY_DIR}/debian/library/shlibs"
                                                 "${packages_dir}/library/triggers")

  pingvox_debian_package(development libpingvox-dev libdevel
                         "3D occupancy maps of scanning sonars, headers and static libraries\n${of_library}")
  set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
      "libpingvox${PINGVOX_SOVERSION} (= ${version}), libeigen3-dev, libfmt-dev, libexpected-dev")
  # Of the static libraries.
  set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS
      "libopencv-imgproc-dev, libhwy-dev, zlib1g-dev, libpng-dev, libbz2-dev, libsqlite3-dev, liblz4-dev, libzstd-dev, libcpp-httplib-dev")
endif()
if(PINGVOX_BUILD_PYTHON)
  find_package(Python 3.9 REQUIRED COMPONENTS Interpreter)
  pingvox_debian_package(
    python python3-pingvox python
    "3D occupancy maps of scanning sonars, Python module
Reads logs of scanning sonars and of navigation, maps them, estimates the
path of the vehicle, and builds, queries and writes 3D occupancy maps, as
arrays of numpy.")
  math(EXPR next_minor "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "python3 (>= 3.${Python_VERSION_MINOR}~), python3 (<< 3.${next_minor}), python3-numpy")
  # Compile the module when it is installed, and remove what was compiled.
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA "${packages_dir}/python/postinst" "${packages_dir}/python/prerm")
endif()

include(CPack)
