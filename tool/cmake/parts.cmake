# The optional parts and the packages behind them. Each part becomes a target softreel_part_NAME, which carries its
# libraries (none if it is off), and SOFTREEL_HAS_NAME, 0|1.
set(SOFTREEL_PART_TABLE "")

# softreel_part(NAME FOUND PACKAGE LIBRARIES... [INCLUDE FOLDERS...]): decides by SOFTREEL_WITH_NAME and by whether PACKAGE
# was found. INCLUDE: where the headers are of libraries that are no targets.
function(softreel_part name found package)
  cmake_parse_arguments(PARSE_ARGV 3 part "" "" "INCLUDE")
  set(wanted "${SOFTREEL_WITH_${name}}")
  add_library(softreel_part_${name} INTERFACE)
  if(wanted STREQUAL "ON" AND NOT found)
    message(FATAL_ERROR "SOFTREEL_WITH_${name} is ON but ${package} was not found. "
                        "Install it (tool/packages.txt names the package) or set SOFTREEL_WITH_${name}=OFF.")
  endif()
  if(found AND NOT wanted STREQUAL "OFF")
    set(value 1)
    target_link_libraries(softreel_part_${name} INTERFACE ${part_UNPARSED_ARGUMENTS})
    target_include_directories(softreel_part_${name} SYSTEM INTERFACE ${part_INCLUDE})
  else()
    set(value 0)
  endif()
  set(SOFTREEL_HAS_${name} ${value} PARENT_SCOPE)
  set(SOFTREEL_PART_TABLE "${SOFTREEL_PART_TABLE}\n  ${name}: ${value}  (${package}, asked: ${wanted})" PARENT_SCOPE)
endfunction()

# softreel_add_part(OWNER NAME CALLER files... SOURCE files... COPIES files...): the sources that include the libraries of
# a part. CALLER, the sources of OWNER that call them through core/base/part.h, are compiled with SOFTREEL_WITH_NAME=0|1,
# and only they: switching a part compiles nothing else again.
# With SOFTREEL_LAZY_PARTS they become the module softreel_part_NAME.so. That needs nothing of the program: the few other
# sources of softreel that they call, COPIES, are compiled into it as well.
function(softreel_add_part owner name)
  cmake_parse_arguments(PARSE_ARGV 2 part "" "" "CALLER;SOURCE;COPIES")
  foreach(caller ${part_CALLER})
    set_property(SOURCE "${CMAKE_CURRENT_SOURCE_DIR}/${caller}" TARGET_DIRECTORY ${owner} APPEND PROPERTY
                 COMPILE_DEFINITIONS SOFTREEL_WITH_${name}=${SOFTREEL_HAS_${name}})
  endforeach()
  if(NOT SOFTREEL_HAS_${name})
    return()
  endif()
  if(NOT SOFTREEL_LAZY_PARTS)
    target_sources(${owner} PRIVATE ${part_SOURCE})
    # Never in a group with others: the groups of the others are the same then, with the part and without it.
    foreach(source ${part_SOURCE})
      set_property(SOURCE "${CMAKE_CURRENT_SOURCE_DIR}/${source}" TARGET_DIRECTORY ${owner}
                   PROPERTY SKIP_UNITY_BUILD_INCLUSION ON)
    endforeach()
    target_link_libraries(${owner} PRIVATE softreel_part_${name})
    return()
  endif()
  string(TOLOWER "softreel_part_${name}" file)
  set(module softreel_module_${name})
  add_library(${module} MODULE ${part_SOURCE} ${part_COPIES})
  set_target_properties(${module} PROPERTIES PREFIX "" OUTPUT_NAME "${file}" CXX_VISIBILITY_PRESET hidden
                        VISIBILITY_INLINES_HIDDEN ON LIBRARY_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/${SOFTREEL_PART_FOLDER}")
  target_include_directories(${module} PRIVATE "${PROJECT_SOURCE_DIR}")
  target_link_libraries(${module} PRIVATE softreel_part_${name} Eigen3::Eigen fmt::fmt softreel_numerics
                        softreel_warnings)
  target_link_options(${module} PRIVATE LINKER:--no-undefined)
  softreel_compile_in_groups(${module} 8)
  install(TARGETS ${module} LIBRARY DESTINATION "${SOFTREEL_PART_FOLDER}")
  add_dependencies(${owner} ${module})
endfunction()

find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(TBB REQUIRED)
find_package(fmt REQUIRED)
find_package(ZLIB REQUIRED)

# softreel_need(NAME HEADER [LIBRARY]): a library that has no CMake package, or of which only headers are used, as the target
# softreel_NAME; an error if it is not there.
function(softreel_need name header)
  string(TOUPPER "SOFTREEL_${name}" variable)
  find_path(${variable}_INCLUDE "${header}")
  add_library(softreel_${name} INTERFACE)
  if(ARGN)
    find_library(${variable} "${ARGN}")
    target_link_libraries(softreel_${name} INTERFACE "${${variable}}")
  endif()
  if(NOT ${variable}_INCLUDE OR (ARGN AND NOT ${variable}))
    message(FATAL_ERROR "softreel needs ${name}: its ${header} or its library was not found. "
                        "Install it (tool/packages.txt names the package).")
  endif()
  target_include_directories(softreel_${name} SYSTEM INTERFACE "${${variable}_INCLUDE}")
endfunction()

softreel_need(stb stb/stb_image.h)
softreel_need(toml toml++/toml.h)
softreel_need(xxhash xxhash.h xxhash)

if(NOT SOFTREEL_WITH_ASSIMP STREQUAL "OFF")
  find_package(assimp QUIET)
endif()
softreel_part(ASSIMP "${assimp_FOUND}" "assimp ${assimp_VERSION}" assimp::assimp)

if(NOT SOFTREEL_WITH_EMBREE STREQUAL "OFF")
  find_package(embree 3 QUIET)
endif()
softreel_part(EMBREE "${embree_FOUND}" "Embree ${embree_VERSION}" embree)

if(NOT SOFTREEL_WITH_EGL STREQUAL "OFF")
  find_package(OpenGL QUIET COMPONENTS EGL)
  find_library(SOFTREEL_EPOXY epoxy)
  find_path(SOFTREEL_EPOXY_INCLUDE epoxy/egl.h)
  if(OpenGL_EGL_FOUND AND SOFTREEL_EPOXY AND SOFTREEL_EPOXY_INCLUDE)
    set(egl_found TRUE)
  endif()
endif()
softreel_part(EGL "${egl_found}" "EGL and epoxy" OpenGL::EGL "${SOFTREEL_EPOXY}"
              INCLUDE "${SOFTREEL_EPOXY_INCLUDE}")

# Debian 12 has no CMake package of OpenVDB, and its Find module lies where CMake does not look.
if(NOT SOFTREEL_WITH_OPENVDB STREQUAL "OFF")
  find_library(SOFTREEL_OPENVDB openvdb)
  find_path(SOFTREEL_OPENVDB_INCLUDE openvdb/openvdb.h)
  find_path(SOFTREEL_BOOST_IOSTREAMS_INCLUDE boost/iostreams/device/array.hpp)
  if(SOFTREEL_OPENVDB AND SOFTREEL_OPENVDB_INCLUDE AND SOFTREEL_BOOST_IOSTREAMS_INCLUDE)
    set(openvdb_found TRUE)
  endif()
endif()
softreel_part(OPENVDB "${openvdb_found}" "OpenVDB" "${SOFTREEL_OPENVDB}" TBB::tbb
              INCLUDE "${SOFTREEL_OPENVDB_INCLUDE}" "${SOFTREEL_BOOST_IOSTREAMS_INCLUDE}")

function(softreel_print_parts)
  message(STATUS "softreel ${PROJECT_VERSION}: ${CMAKE_BUILD_TYPE}, tests ${SOFTREEL_BUILD_TESTS}, benchmarks "
                 "${SOFTREEL_BUILD_BENCHMARKS}, sanitizers '${SOFTREEL_SANITIZE}', lazy parts ${SOFTREEL_LAZY_PARTS}; parts:${SOFTREEL_PART_TABLE}")
endfunction()
