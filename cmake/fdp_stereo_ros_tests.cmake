# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# test/ros/<name>_test.cpp: a gtest without a roscore, or with a <name>.test beside it a rostest.
if(CATKIN_ENABLE_TESTING)
  find_package(rostest REQUIRED)

  function(fdp_stereo_add_ros_test name)
    set(launch ${PROJECT_SOURCE_DIR}/test/ros/${name}.test)
    add_executable(${name}_test EXCLUDE_FROM_ALL ${PROJECT_SOURCE_DIR}/test/ros/${name}_test.cpp)
    target_include_directories(${name}_test PRIVATE ${PROJECT_SOURCE_DIR}/test)
    target_compile_definitions(${name}_test PRIVATE FDP_STEREO_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
      FDP_STEREO_TOOL_DIR="${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION}")
    target_link_libraries(${name}_test PRIVATE fdp_stereo_nodelet GTest::gtest)
    set_target_properties(${name}_test PROPERTIES
      RUNTIME_OUTPUT_DIRECTORY ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION})
    add_dependencies(tests ${name}_test)
    if(EXISTS ${launch})
      add_rostest(${launch} DEPENDENCIES ${name}_test)
    else()
      target_link_libraries(${name}_test PRIVATE GTest::gtest_main)
      add_test(NAME ${name}_test COMMAND ${name}_test)
    endif()
  endfunction()

  fdp_stereo_add_ros_test(conversions)
  fdp_stereo_add_ros_test(params_ros)
  fdp_stereo_add_ros_test(frame_worker)
  fdp_stereo_add_ros_test(frame_processor)
  fdp_stereo_add_ros_test(seed_conversions)
  fdp_stereo_add_ros_test(node_status)
  fdp_stereo_add_ros_test(diagnosis)
  fdp_stereo_add_ros_test(disparity_nodelet)
  fdp_stereo_add_ros_test(bad_input)
  fdp_stereo_add_ros_test(life_cycle)
  fdp_stereo_add_ros_test(points)
  fdp_stereo_add_ros_test(seeds)
  fdp_stereo_add_ros_test(euroc)
  add_test(NAME master_gone COMMAND ${PROJECT_SOURCE_DIR}/test/ros/master_gone_test.sh ${CATKIN_DEVEL_PREFIX})
  include(cmake/fdp_stereo_fuzz.cmake)
endif()
