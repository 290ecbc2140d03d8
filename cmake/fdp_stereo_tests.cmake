# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Every test/core/<stage>_test.cpp is a gtest of its own, run by ctest.
set(FDP_STEREO_TEST_OPTIONS $<$<CONFIG:Release>:-O1>) # compiling the tests takes longer than running them
file(GLOB FDP_STEREO_CORE_TESTS CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/test/core/*_test.cpp)
foreach(source IN LISTS FDP_STEREO_CORE_TESTS)
  get_filename_component(name ${source} NAME_WE)
  add_executable(${name} EXCLUDE_FROM_ALL ${source})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/test ${PROJECT_SOURCE_DIR}/src/core)
  target_compile_definitions(${name} PRIVATE FDP_STEREO_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  target_compile_options(${name} PRIVATE ${FDP_STEREO_TEST_OPTIONS})
  target_link_libraries(${name} PRIVATE fdp_stereo_evaluation GTest::gtest GTest::gtest_main OpenMP::OpenMP_CXX)
  add_test(NAME ${name} COMMAND ${name})
  set_tests_properties(${name} PROPERTIES LABELS core)
  list(APPEND FDP_STEREO_CORE_TEST_TARGETS ${name})
endforeach()
# The places that OpenCV 4.2 has no function for, built and run as they are there.
add_executable(feature_matching_opencv_42_test EXCLUDE_FROM_ALL
  test/core/feature_matching_test.cpp src/core/features/feature_matching.cpp)
target_include_directories(feature_matching_opencv_42_test PRIVATE test src/core)
target_compile_definitions(feature_matching_opencv_42_test PRIVATE FDP_STEREO_FORCE_OPENCV_42)
target_link_libraries(feature_matching_opencv_42_test PRIVATE fdp_stereo_core GTest::gtest GTest::gtest_main OpenMP::OpenMP_CXX)
add_test(NAME feature_matching_opencv_42_test COMMAND feature_matching_opencv_42_test)
set_tests_properties(feature_matching_opencv_42_test PROPERTIES LABELS core)
add_custom_target(core_tests DEPENDS ${FDP_STEREO_CORE_TEST_TARGETS} feature_matching_opencv_42_test)
# After a change of the results that is meant.
add_custom_target(update_golden
  COMMAND golden_test --gtest_also_run_disabled_tests --gtest_filter=UpdateGolden.* VERBATIM)
if(TARGET tests)
  add_dependencies(tests core_tests)
endif()

# Every test/tools/*_test.py drives the programs as a user does, test/docs/*_test.py the commands of the documents.
find_package(Python3 REQUIRED COMPONENTS Interpreter)
set(FDP_STEREO_FOLDERS "FDP_STEREO_BUILD=${PROJECT_BINARY_DIR};FDP_STEREO_SOURCE=${PROJECT_SOURCE_DIR}")
file(GLOB FDP_STEREO_SCRIPT_TESTS CONFIGURE_DEPENDS
  ${PROJECT_SOURCE_DIR}/test/tools/*_test.py ${PROJECT_SOURCE_DIR}/test/docs/*_test.py)
if(NOT TARGET match)
  set(FDP_STEREO_SCRIPT_TESTS)
elseif(NOT FDP_STEREO_ROS)
  list(FILTER FDP_STEREO_SCRIPT_TESTS EXCLUDE REGEX "/docs/") # the documents describe the build with ROS
endif()
foreach(script IN LISTS FDP_STEREO_SCRIPT_TESTS)
  get_filename_component(name ${script} NAME_WE)
  get_filename_component(folder ${script} DIRECTORY)
  get_filename_component(label ${folder} NAME)
  add_test(NAME ${label}_${name} COMMAND ${Python3_EXECUTABLE} ${script})
  set_tests_properties(${label}_${name} PROPERTIES LABELS ${label}
    ENVIRONMENT "FDP_STEREO_BIN=$<TARGET_FILE_DIR:match>;${FDP_STEREO_FOLDERS}")
endforeach()

add_test(NAME docs_site_builds COMMAND ${PROJECT_SOURCE_DIR}/scripts/docs.sh ${PROJECT_BINARY_DIR})
set_tests_properties(docs_site_builds PROPERTIES LABELS docs)
# An installed library is used from outside; with ROS and tools the whole install space.
set(_install_tests library)
if(FDP_STEREO_ROS AND TARGET match)
  list(APPEND _install_tests install)
endif()
foreach(name IN LISTS _install_tests)
  add_test(NAME ${name}_test COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/test/install/${name}_test.py)
  set_tests_properties(${name}_test PROPERTIES LABELS install ENVIRONMENT "${FDP_STEREO_FOLDERS}")
endforeach()
if(FDP_STEREO_ROS)
  add_test(NAME workspaces_configure COMMAND ${PROJECT_SOURCE_DIR}/scripts/test_workspaces.sh --quick)
  set_tests_properties(workspaces_configure PROPERTIES LABELS install)
endif()

add_test(NAME docs_parameters_are_current
  COMMAND sh -c "$<TARGET_FILE:parameters_doc> | diff ${PROJECT_SOURCE_DIR}/docs/parameters.md -")
set_tests_properties(docs_parameters_are_current PROPERTIES LABELS docs)

# The linters of scripts/lint.sh; tidy reads the compile commands of this build.
foreach(check format functions shell catkin tidy)
  add_test(NAME lint_${check} COMMAND ${PROJECT_SOURCE_DIR}/scripts/lint.sh ${check} ${PROJECT_BINARY_DIR})
  set_tests_properties(lint_${check} PROPERTIES LABELS lint)
endforeach()
# It takes longest: it starts first, on all processors, and lets other tests go before.
set_tests_properties(lint_tidy PROPERTIES COST 1000 TIMEOUT 3600)
