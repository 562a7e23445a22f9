# softreel_precompile(TARGET PRIVATE HEADERS... | REUSE_FROM OTHER): the headers that most sources of a target include,
# compiled once, which halves the time that a source takes; or those of a target that is compiled with equal options.
# Sources include what they need all the same: tool/test --includes finds what they forget. g++ compiles with the level
# of optimisation that its precompiled header was made with, and ignores another one: a level is given to a whole target,
# never to a source.
function(softreel_precompile target)
  if(NOT SOFTREEL_PRECOMPILE)
    return()
  endif()
  target_precompile_headers(${target} ${ARGN})
  # With them g++ 12 takes the system headers' own code for ours, and warns of std::string wrongly (its bug 105651).
  target_compile_options(${target} PRIVATE -Wno-array-bounds -Wno-stringop-overflow)
  if(CMAKE_CXX_COMPILER_LAUNCHER MATCHES "ccache")
    target_compile_options(${target} PRIVATE -fpch-preprocess)  # what ccache asks for
  endif()
endfunction()

# softreel_compile_in_groups(TARGET SIZE): at most so many sources of a folder at a time, which reads their headers and
# makes their templates once; not those that are written for vector instructions (_simd.cpp). Names in anonymous
# namespaces of one folder must differ. For what is compiled whole more often than source by source; called when the
# target has all its sources.
function(softreel_compile_in_groups target size)
  if(NOT SOFTREEL_PRECOMPILE)  # where it is asked what sources forget to include
    return()
  endif()
  get_target_property(sources ${target} SOURCES)
  get_target_property(target_folder ${target} SOURCE_DIR)
  set(folders)
  foreach(source ${sources})
    get_source_file_property(alone "${source}" TARGET_DIRECTORY ${target} SKIP_UNITY_BUILD_INCLUSION)
    if(alone OR source MATCHES "_simd\\.cpp$")
      continue()
    endif()
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY "${target_folder}")
    cmake_path(RELATIVE_PATH source BASE_DIRECTORY "${PROJECT_SOURCE_DIR}" OUTPUT_VARIABLE relative)
    cmake_path(GET relative PARENT_PATH folder)
    list(APPEND folders "${folder}")
    list(APPEND "sources of ${folder}" "${source}")
  endforeach()
  list(REMOVE_DUPLICATES folders)
  foreach(folder ${folders})
    list(LENGTH "sources of ${folder}" count)
    math(EXPR groups "(${count} + ${size} - 1) / ${size}")
    string(REPLACE "/" "_" name "${folder}")
    set(place 0)
    foreach(source IN LISTS "sources of ${folder}")
      math(EXPR group "${place} * ${groups} / ${count}")
      set_property(SOURCE "${source}" TARGET_DIRECTORY ${target} PROPERTY UNITY_GROUP "${name}_${group}")
      math(EXPR place "${place} + 1")
    endforeach()
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
endfunction()

set(SOFTREEL_COMMON_HEADERS <algorithm> <array> <cmath> <cstdint> <functional> <map> <memory> <optional> <span> <string>
    <vector> <Eigen/Core> <Eigen/Geometry> <fmt/format.h>)
# What two of three sources that deal with shots include, which takes a second and a half to read.
set(SOFTREEL_SHOT_HEADERS <filesystem> <set> <variant> <fmt/ranges.h> "${PROJECT_SOURCE_DIR}/tool/shot/shot.h")
set(SOFTREEL_TEST_HEADERS ${SOFTREEL_COMMON_HEADERS} <random> <gtest/gtest.h>)
