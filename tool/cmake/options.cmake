# Build type, language, options.
if(PROJECT_IS_TOP_LEVEL AND NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Release, RelWithDebInfo, Debug" FORCE)
endif()
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

option(SOFTREEL_BUILD_TESTS "build the tests" ${PROJECT_IS_TOP_LEVEL})
option(SOFTREEL_BUILD_BENCHMARKS "build tests/benchmark" OFF)
option(SOFTREEL_BUILD_FUZZERS "tests/fuzz for libFuzzer, which needs clang" OFF)
option(SOFTREEL_WERROR "warnings are errors" OFF)
option(SOFTREEL_PRECOMPILE "compile common headers once" ON)
set(SOFTREEL_SANITIZE "" CACHE STRING "sanitizers, for example address,undefined")
option(SOFTREEL_LAZY_PARTS "load the parts below when they are first used" ${PROJECT_IS_TOP_LEVEL})
if(SOFTREEL_SANITIZE AND SOFTREEL_LAZY_PARTS)
  # The sanitizers put their own dlopen before the program's, and with it their own RUNPATH.
  message(STATUS "softreel: SOFTREEL_LAZY_PARTS is off with SOFTREEL_SANITIZE")
  set(SOFTREEL_LAZY_PARTS OFF)
endif()
foreach(part EMBREE EGL ASSIMP OPENVDB)
  set(SOFTREEL_WITH_${part} AUTO CACHE STRING "AUTO: on if found; ON: an error if not found; OFF")
  set_property(CACHE SOFTREEL_WITH_${part} PROPERTY STRINGS AUTO ON OFF)
endforeach()

# The layout under the prefix is fixed, bin/, lib/softreel/ and share/, whatever CMAKE_INSTALL_BINDIR and its like say: the
# program finds its parts and presets from where it lies, so that a build folder, or an installation, may be moved. Built
# and installed programs have the same path to parts: one to be replaced is filled up with colons, and an empty path
# between them is the current folder.
set(SOFTREEL_PART_FOLDER "lib/softreel")
if(SOFTREEL_LAZY_PARTS)
  set(CMAKE_BUILD_WITH_INSTALL_RPATH ON)
  set(CMAKE_INSTALL_RPATH_USE_LINK_PATH ON)
  set(CMAKE_INSTALL_RPATH "$ORIGIN/../${SOFTREEL_PART_FOLDER}")
endif()
