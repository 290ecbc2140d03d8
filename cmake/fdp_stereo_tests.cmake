# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Every test/core/<stage>_test.cpp is a gtest of its own, run by ctest.
file(GLOB FDP_STEREO_CORE_TESTS CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/test/core/*_test.cpp)
foreach(source IN LISTS FDP_STEREO_CORE_TESTS)
  get_filename_component(name ${source} NAME_WE)
  add_executable(${name} EXCLUDE_FROM_ALL ${source})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/test ${PROJECT_SOURCE_DIR}/src/core)
  target_compile_definitions(${name} PRIVATE FDP_STEREO_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  target_link_libraries(${name} PRIVATE fdp_stereo_evaluation GTest::gtest GTest::gtest_main OpenMP::OpenMP_CXX)
  add_test(NAME ${name} COMMAND ${name})
  set_tests_properties(${name} PROPERTIES LABELS core)
  list(APPEND FDP_STEREO_CORE_TEST_TARGETS ${name})
endforeach()
add_custom_target(core_tests DEPENDS ${FDP_STEREO_CORE_TEST_TARGETS})
if(TARGET tests)
  add_dependencies(tests core_tests)
endif()

# Every test/tools/*_test.py drives the programs as a user does, test/docs/*_test.py the commands of the documents.
find_package(Python3 REQUIRED COMPONENTS Interpreter)
file(GLOB FDP_STEREO_SCRIPT_TESTS CONFIGURE_DEPENDS
  ${PROJECT_SOURCE_DIR}/test/tools/*_test.py ${PROJECT_SOURCE_DIR}/test/docs/*_test.py)
foreach(script IN LISTS FDP_STEREO_SCRIPT_TESTS)
  get_filename_component(name ${script} NAME_WE)
  get_filename_component(folder ${script} DIRECTORY)
  get_filename_component(label ${folder} NAME)
  add_test(NAME ${label}_${name} COMMAND ${Python3_EXECUTABLE} ${script})
  set_tests_properties(${label}_${name} PROPERTIES LABELS ${label}
    ENVIRONMENT "FDP_STEREO_BIN=$<TARGET_FILE_DIR:match>;FDP_STEREO_SOURCE=${PROJECT_SOURCE_DIR}")
endforeach()

add_test(NAME docs_site_builds COMMAND ${PROJECT_SOURCE_DIR}/scripts/docs.sh)
set_tests_properties(docs_site_builds PROPERTIES LABELS docs)
if(FDP_STEREO_ROS)
  add_test(NAME install_space_test COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/test/install/install_test.py)
  set_tests_properties(install_space_test PROPERTIES LABELS install
    ENVIRONMENT "FDP_STEREO_BUILD=${PROJECT_BINARY_DIR};FDP_STEREO_SOURCE=${PROJECT_SOURCE_DIR}")
  add_test(NAME workspaces_configure COMMAND ${PROJECT_SOURCE_DIR}/scripts/test_workspaces.sh --quick)
  set_tests_properties(workspaces_configure PROPERTIES LABELS install)
endif()

add_test(NAME docs_parameters_are_current
  COMMAND sh -c "$<TARGET_FILE:parameters_doc> | diff ${PROJECT_SOURCE_DIR}/docs/parameters.md -")
set_tests_properties(docs_parameters_are_current PROPERTIES LABELS docs)

# The linters of scripts/lint.sh; tidy reads the compile commands of this build.
foreach(check format shell catkin tidy)
  add_test(NAME lint_${check} COMMAND ${PROJECT_SOURCE_DIR}/scripts/lint.sh ${check} ${PROJECT_BINARY_DIR})
  set_tests_properties(lint_${check} PROPERTIES LABELS lint)
endforeach()
