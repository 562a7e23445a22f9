# softreel_precompile(TARGET HEADERS...): the headers that most sources of a target include, compiled once, which halves
# the time that a source takes. Sources include what they need all the same: tool/test --includes finds what they forget.
function(softreel_precompile target)
  if(NOT SOFTREEL_PRECOMPILE)
    return()
  endif()
  target_precompile_headers(${target} PRIVATE ${ARGN})
  # With them g++ 12 takes the system headers' own code for ours, and warns of std::string wrongly (its bug 105651).
  target_compile_options(${target} PRIVATE -Wno-array-bounds -Wno-stringop-overflow)
  if(CMAKE_CXX_COMPILER_LAUNCHER MATCHES "ccache")
    target_compile_options(${target} PRIVATE -fpch-preprocess)  # what ccache asks for
  endif()
endfunction()

# softreel_compile_in_groups(TARGET SIZE): so many sources at a time, which reads their headers and makes their templates
# once. Names in anonymous namespaces of one group must differ. For what is compiled whole more often than source by source.
function(softreel_compile_in_groups target size)
  if(SOFTREEL_PRECOMPILE)  # not where it is asked what sources forget to include
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${size})
  endif()
endfunction()

set(SOFTREEL_COMMON_HEADERS <algorithm> <array> <cmath> <cstdint> <functional> <map> <memory> <optional> <span> <string>
    <vector> <Eigen/Core> <Eigen/Geometry> <fmt/format.h>)
# What two of three sources that deal with shots include, which takes a second and a half to read.
set(SOFTREEL_SHOT_HEADERS <filesystem> <set> <variant> <fmt/ranges.h> "${PROJECT_SOURCE_DIR}/tool/shot/shot.h")
