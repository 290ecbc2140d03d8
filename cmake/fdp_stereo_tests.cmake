# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Every test/core/<stage>_test.cpp is a gtest of its own, run by ctest.
find_package(GTest REQUIRED)
file(GLOB FDP_STEREO_CORE_TESTS CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/test/core/*_test.cpp)
foreach(source IN LISTS FDP_STEREO_CORE_TESTS)
  get_filename_component(name ${source} NAME_WE)
  add_executable(${name} EXCLUDE_FROM_ALL ${source})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/test ${PROJECT_SOURCE_DIR}/src/core)
  target_compile_definitions(${name} PRIVATE FDP_STEREO_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  target_link_libraries(${name} PRIVATE fdp_stereo_core GTest::gtest GTest::gtest_main OpenMP::OpenMP_CXX)
  add_test(NAME ${name} COMMAND ${name})
  list(APPEND FDP_STEREO_CORE_TEST_TARGETS ${name})
endforeach()
add_custom_target(core_tests DEPENDS ${FDP_STEREO_CORE_TEST_TARGETS})
if(TARGET tests)
  add_dependencies(tests core_tests)
endif()
