# The one place that says how our targets are compiled.

if(PINGVOX_CLANG_TIDY)
  find_program(PINGVOX_CLANG_TIDY_PROGRAM "${PINGVOX_CLANG_TIDY}" REQUIRED)
  # Sources are checked again when the configuration changes: its hash is part of the command.
  set_property(DIRECTORY "${PROJECT_SOURCE_DIR}" APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS .clang-tidy)
  file(MD5 "${PROJECT_SOURCE_DIR}/.clang-tidy" tidy_config_hash)
  set(PINGVOX_CLANG_TIDY_COMMAND "${PINGVOX_CLANG_TIDY_PROGRAM};--quiet;--extra-arg=-DCONFIG_${tidy_config_hash}")
endif()

# pingvox_compile_options(TARGET): language level, warnings, sanitizers and clang-tidy.
function(pingvox_compile_options target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF CXX_CLANG_TIDY "${PINGVOX_CLANG_TIDY_COMMAND}")
  # A product and a sum rounded at once would make cells depend on the processor.
  target_compile_options(${target} PRIVATE -ffp-contract=off)
  # Shadowing is g++'s part: clang 19 takes [from = from] of a structured binding for it.
  target_compile_options(
    ${target} PRIVATE -Wall -Wextra -Wpedantic $<$<CXX_COMPILER_ID:GNU>:-Wshadow> -Wconversion -Wnon-virtual-dtor
                      -Wold-style-cast -Woverloaded-virtual $<$<BOOL:${PINGVOX_WARNINGS_AS_ERRORS}>:-Werror>)
  if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # A source that another file includes looks like a header, whose types have to be the same everywhere.
    target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
  endif()
  if(PINGVOX_SANITIZE)
    string(REPLACE "," ";" sanitizers "${PINGVOX_SANITIZE}")
    target_compile_options(${target} PRIVATE -fsanitize=${PINGVOX_SANITIZE} -fno-omit-frame-pointer
                                             -fno-sanitize-recover=all)
    if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
      target_compile_options(
        ${target} PRIVATE "-fsanitize-ignorelist=${CMAKE_CURRENT_FUNCTION_LIST_DIR}/sanitizers_ignore.txt")
    endif()
    target_compile_definitions(${target} PRIVATE _GLIBCXX_ASSERTIONS)
    # Each compiler tells it in another way.
    foreach(sanitizer IN ITEMS ADDRESS THREAD)
      string(TOLOWER ${sanitizer} name)
      if(name IN_LIST sanitizers)
        target_compile_definitions(${target} PRIVATE PINGVOX_SANITIZE_${sanitizer})
      endif()
    endforeach()
    target_link_options(${target} PUBLIC -fsanitize=${PINGVOX_SANITIZE})
  endif()
endfunction()

# pingvox_check_fewer_pointers(TARGET): leaves out the dearest checks of the undefined behaviour sanitizer, where no raw
# bytes are looked at: null pointers and objects that are too small the address sanitizer sees as well, and only casts
# give a wrong alignment. It halves the time of code on Eigen's small matrices.
function(pingvox_check_fewer_pointers target)
  if(PINGVOX_SANITIZE MATCHES "undefined")
    target_compile_options(${target} PRIVATE -fno-sanitize=null,alignment,object-size)
  endif()
endfunction()

# pingvox_use_highway(TARGET): vector code by Google Highway, and which machines it is compiled for: AVX-512, AVX2, NEON
# and any (scalar). SSE4 and SVE are left out: too narrow to gain, and vectors of unknown size.
function(pingvox_use_highway target)
  set(disabled HWY_SSSE3 HWY_SSE4 HWY_SVE HWY_SVE2 HWY_SVE_256 HWY_SVE2_128)
  if(PINGVOX_KERNELS)
    list(APPEND disabled HWY_AVX3)
  endif()
  if(PINGVOX_KERNELS STREQUAL SCALAR)
    list(APPEND disabled HWY_AVX2 HWY_NEON)
  endif()
  list(JOIN disabled "|" disabled)
  target_compile_definitions(${target} PRIVATE HWY_COMPILE_ALL_ATTAINABLE HWY_BROKEN_EMU128=1
                                               "HWY_DISABLED_TARGETS=(${disabled})")
  # By name, not by path, as it is found on the machine that links.
  target_link_libraries(${target} PRIVATE hwy)
endfunction()

# pingvox_use_cyclone(TARGET): topics of ROS 2 by Cyclone DDS, where it is installed. Its structs for messages of one's
# own are those of 0.10, built with shared memory, as Debian has it.
function(pingvox_use_cyclone target)
  find_package(CycloneDDS 0.10 QUIET)
  if(TARGET CycloneDDS::ddsc)
    get_target_property(has_shared_memory CycloneDDS::ddsc SHM_SUPPORT_IS_AVAILABLE)
  endif()
  if(NOT CycloneDDS_VERSION MATCHES "^0\\.10\\." OR NOT has_shared_memory)
    message(STATUS "Cyclone DDS 0.10 (cyclonedds-dev) is not installed: no topics of ROS 2")
    return()
  endif()
  # Structs depend on how the library was built, which its headers do not say.
  target_compile_definitions(${target} PRIVATE PINGVOX_HAS_ROS2 DDS_NDEBUG DDS_HAS_SHM)
  # By name, not by path: an installed pingvox is linked with the libraries of the machine it is on.
  target_link_libraries(${target} PRIVATE ddsc)
endfunction()

# Layers that look at raw bytes or memory. No other may cast pointers (tests/layers).
set(PINGVOX_RAW_LAYERS map cloud io device)

# pingvox_layer(NAME [DEPENDS LAYER...]): one folder of src/, with those in it, and of include/pingvox/, as one target.
# Headers for users are in include/pingvox/NAME, those for other layers and the program in src/NAME/internal, which are
# not installed.
function(pingvox_layer name)
  cmake_parse_arguments(LAYER "" "" "DEPENDS" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/src/${name}/*.cpp")
  set(kernels ${sources})
  list(FILTER kernels INCLUDE REGEX "/kernels/[^/]+$")
  if(kernels)
    # Highway includes each once for every kind of vector.
    set_source_files_properties(${kernels} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endif()
  list(TRANSFORM LAYER_DEPENDS PREPEND pingvox_)
  if(sources)
    add_library(pingvox_${name} STATIC ${sources})
    pingvox_compile_options(pingvox_${name})
    if(NOT name IN_LIST PINGVOX_RAW_LAYERS)
      pingvox_check_fewer_pointers(pingvox_${name})
    endif()
    set_target_properties(pingvox_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    if(NOT PINGVOX_UNITY_LAYERS)
      set_target_properties(pingvox_${name} PROPERTIES UNITY_BUILD OFF)
    endif()
    if(name STREQUAL geometry)
      pingvox_precompile(pingvox_${name})
    else()
      pingvox_share_precompiled(pingvox_${name} pingvox_geometry)
    endif()
    target_include_directories(pingvox_${name} PRIVATE "${PROJECT_SOURCE_DIR}/src")
    set(scope PUBLIC)
  else()
    add_library(pingvox_${name} INTERFACE)
    target_compile_features(pingvox_${name} INTERFACE cxx_std_20)
    set(scope INTERFACE)
  endif()
  add_library(pingvox::${name} ALIAS pingvox_${name})
  set_target_properties(pingvox_${name} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(pingvox_${name} ${scope} $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                                             $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(pingvox_${name} ${scope} ${LAYER_DEPENDS})
  set(PINGVOX_LAYERS ${PINGVOX_LAYERS} pingvox_${name} PARENT_SCOPE)
endfunction()

# pingvox_unity_by_folder(LAYER): the sources of each folder in src/LAYER are compiled together, where sources are
# compiled several at once. Readers of formats name their parts alike: names have to differ within a folder only.
function(pingvox_unity_by_folder layer)
  get_target_property(sources pingvox_${layer} SOURCES)
  foreach(source IN LISTS sources)
    cmake_path(GET source PARENT_PATH folder)
    cmake_path(GET folder FILENAME folder)
    set_source_files_properties("${source}" TARGET_DIRECTORY pingvox_${layer} PROPERTIES UNITY_GROUP ${folder})
  endforeach()
  set_target_properties(pingvox_${layer} PROPERTIES UNITY_BUILD_MODE GROUP)
endfunction()
