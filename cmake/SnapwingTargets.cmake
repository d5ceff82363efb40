# Helpers that keep each layer's CMakeLists.txt to its sources and what it stands on.
include(GoogleTest)

set(SNAPWING_WARNINGS -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual)
if(SNAPWING_WERROR)
  list(APPEND SNAPWING_WARNINGS -Werror)
endif()

function(snapwing_compile_settings target)
  target_compile_options(${target} PRIVATE ${SNAPWING_WARNINGS})
  if(SNAPWING_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${SNAPWING_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
    target_link_options(${target} PRIVATE -fsanitize=${SNAPWING_SANITIZE})
  endif()
endfunction()

include(SnapwingPrecompiled)
snapwing_pch_holder(library HEADERS ${SNAPWING_PCH_STANDARD} ${SNAPWING_PCH_EIGEN} LINKS Eigen3::Eigen)
snapwing_pch_holder(tool PROGRAM HEADERS ${SNAPWING_PCH_STANDARD} ${SNAPWING_PCH_EIGEN} <CLI/CLI.hpp> <nlohmann/json.hpp>
                    LINKS Eigen3::Eigen CLI11::CLI11 nlohmann_json::nlohmann_json)
if(SNAPWING_TESTS)
  snapwing_pch_holder(test PROGRAM HEADERS ${SNAPWING_PCH_STANDARD} ${SNAPWING_PCH_EIGEN} <gtest/gtest.h> <random>
                      LINKS Eigen3::Eigen GTest::gtest)
endif()

# snapwing_add_layer(<layer> SOURCES a.cpp ... STANDS_ON <target> ...)
function(snapwing_add_layer layer)
  cmake_parse_arguments(ARG "" "" "SOURCES;STANDS_ON" ${ARGN})
  add_library(snapwing_${layer} SHARED ${ARG_SOURCES})
  target_include_directories(snapwing_${layer} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                                                      $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(snapwing_${layer} PUBLIC ${ARG_STANDS_ON})
  snapwing_compile_settings(snapwing_${layer})
  snapwing_precompile(snapwing_${layer} library)
  set_property(GLOBAL APPEND PROPERTY SNAPWING_LIBRARIES snapwing_${layer})
endfunction()

# snapwing_add_program(<name> SOURCES a.cpp ... LINKS <target> ...): runs without ROS; in a catkin build it lies where
# rosrun and roslaunch look for it.
function(snapwing_add_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LINKS})
  snapwing_compile_settings(${name})
  if(SNAPWING_WITH_ROS)
    set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CATKIN_DEVEL_PREFIX}/lib/${PROJECT_NAME})
  endif()
  set_property(GLOBAL APPEND PROPERTY SNAPWING_PROGRAMS ${name})
endfunction()

# snapwing_look_inside(<target> <folder below src> ...): may include what a layer keeps to itself: its programs and tests.
function(snapwing_look_inside target)
  foreach(folder ${ARGN})
    target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/src/${folder})
  endforeach()
endfunction()

# Tests and benchmarks find shipped files through support/paths.h.
if(SNAPWING_TESTS OR SNAPWING_BENCH)
  add_library(snapwing_test_paths STATIC ${PROJECT_SOURCE_DIR}/test/support/paths.cpp)
  target_include_directories(snapwing_test_paths PUBLIC ${PROJECT_SOURCE_DIR}/test)
  target_compile_definitions(snapwing_test_paths PRIVATE SNAPWING_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
endif()

if(SNAPWING_TESTS)
  add_library(snapwing_test_main STATIC ${PROJECT_SOURCE_DIR}/test/support/main.cpp)
  target_link_libraries(snapwing_test_main PUBLIC GTest::gtest)
  snapwing_compile_settings(snapwing_test_main)
endif()

# snapwing_add_gtest(<name> SOURCES a.cpp ... LINKS <target> ...): every case becomes one ctest test.
function(snapwing_add_gtest name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LINKS} snapwing_test_paths snapwing_test_main)
  snapwing_compile_settings(${name})
  snapwing_precompile(${name} test)
  gtest_discover_tests(${name} TEST_PREFIX "${name}." DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 300)
endfunction()
