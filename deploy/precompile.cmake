# Gives every library and test of the project the precompiled headers that suit its options.
set(standard <algorithm> <array> <cmath> <complex> <cstddef> <cstdint> <functional> <limits> <map> <memory> <numbers>
  <numeric> <optional> <span> <string> <string_view> <utility> <vector>)

# Holders: what they compile is what those that reuse it are compiled with.
function(hold name kind source)
  cmake_parse_arguments(ARG "" "" "OPTIONS;LIBRARIES;HEADERS" ${ARGN})
  if(kind STREQUAL EXECUTABLE)
    add_executable(${name} EXCLUDE_FROM_ALL ${source})
  else()
    add_library(${name} STATIC EXCLUDE_FROM_ALL ${source})
  endif()
  target_link_libraries(${name} PRIVATE kolsky_options ${ARG_LIBRARIES})
  target_compile_options(${name} PRIVATE -fpch-preprocess ${ARG_OPTIONS})
  target_precompile_headers(${name} PRIVATE ${standard} ${ARG_HEADERS})
endfunction()
hold(kolsky_headers LIBRARY processing/headers/plain.cpp)
hold(kolsky_numeric_headers LIBRARY processing/headers/numeric.cpp OPTIONS -fcx-limited-range
  LIBRARIES Eigen3::Eigen HEADERS <Eigen/Core>)
if(KOLSKY_TESTS)
  hold(kolsky_test_headers EXECUTABLE tests/headers.cpp OPTIONS $<$<CONFIG:Release>:-O1> LIBRARIES GTest::gtest Eigen3::Eigen
    HEADERS <filesystem> <fstream> <random> <sstream> <gtest/gtest.h> <Eigen/Core>)
endif()

# GCC 12 sees overflows in std::string that are not there, and says so of a precompiled header, which it does not know to be
# the system's. Builds without one still warn of the project's own.
set(no_false_alarms -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread)

# What has options of its own reads its headers itself.
function(reuse target)
  get_target_property(type ${target} TYPE)
  get_target_property(libraries ${target} LINK_LIBRARIES)
  get_target_property(options ${target} COMPILE_OPTIONS)
  if(type STREQUAL STATIC_LIBRARY AND options MATCHES "-fcx-limited-range")
    set(holder kolsky_numeric_headers)
  elseif(type STREQUAL STATIC_LIBRARY AND NOT options)
    set(holder kolsky_headers)
  elseif(type STREQUAL EXECUTABLE AND libraries MATCHES "GTest::gtest")
    set(holder kolsky_test_headers)
  else()
    return()
  endif()
  target_compile_options(${target} PRIVATE -fpch-preprocess ${no_false_alarms})
  target_precompile_headers(${target} REUSE_FROM ${holder})
  get_target_property(sources ${target} SOURCES)

  get_target_property(directory ${target} SOURCE_DIR)
  list(TRANSFORM sources PREPEND ${directory}/)
  foreach(source ${sources})
    get_source_file_property(own ${source} TARGET_DIRECTORY ${target} COMPILE_OPTIONS)
    if(own)
      set_source_files_properties(${source} TARGET_DIRECTORY ${target} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
    endif()
  endforeach()
endfunction()

function(reuse_below directory)
  get_property(targets DIRECTORY ${directory} PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target ${targets})
    if(NOT target MATCHES "_headers$|^kolsky_proto$")
      reuse(${target})
    endif()
  endforeach()
  get_property(below DIRECTORY ${directory} PROPERTY SUBDIRECTORIES)
  foreach(one ${below})
    reuse_below(${one})
  endforeach()
endfunction()
reuse_below(${PROJECT_SOURCE_DIR})
