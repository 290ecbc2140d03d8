# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# test/ros/<name>_test.cpp: a gtest without a roscore, or with a <name>.test beside it a rostest. Its label is ros where
# the nodelet runs in the test's own process, which the sanitizers then see; manager where nodelet's manager, a program
# of the system, loads it.
if(CATKIN_ENABLE_TESTING)
  find_package(rostest REQUIRED)
  find_package(roslaunch REQUIRED)
  roslaunch_add_file_check(launch/stereo.launch manager:=/stereo_manager)
  if(TARGET match) # these start command-line tools
    foreach(launch demo doctor latency)
      roslaunch_add_file_check(launch/${launch}.launch)
    endforeach()
  endif()

  add_custom_target(ros_tests)
  add_dependencies(tests ros_tests)

  function(fdp_stereo_add_ros_test name label)
    set(launch ${PROJECT_SOURCE_DIR}/test/ros/${name}.test)
    add_executable(${name}_test EXCLUDE_FROM_ALL ${PROJECT_SOURCE_DIR}/test/ros/${name}_test.cpp)
    target_include_directories(${name}_test PRIVATE ${PROJECT_SOURCE_DIR}/test)
    target_compile_definitions(${name}_test PRIVATE FDP_STEREO_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
      FDP_STEREO_TOOL_DIR="${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION}")
    target_link_libraries(${name}_test PRIVATE fdp_stereo_nodelet GTest::gtest)
    set_target_properties(${name}_test PROPERTIES
      RUNTIME_OUTPUT_DIRECTORY ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION})
    add_dependencies(ros_tests ${name}_test)
    if(EXISTS ${launch})
      add_rostest(${launch} DEPENDENCIES ${name}_test)
      set(test _ctest_${PROJECT_NAME}_rostest_test_ros_${name}.test)
    else()
      target_link_libraries(${name}_test PRIVATE GTest::gtest_main)
      set(test ${name}_test)
      add_test(NAME ${test} COMMAND ${name}_test)
    endif()
    set_tests_properties(${test} PROPERTIES LABELS ${label})
  endfunction()

  fdp_stereo_add_ros_test(camera ros)
  fdp_stereo_add_ros_test(conversions ros)
  fdp_stereo_add_ros_test(params_ros ros)
  fdp_stereo_add_ros_test(pair_synchronizer ros)
  fdp_stereo_add_ros_test(stamped_buffer ros)
  fdp_stereo_add_ros_test(frame_worker ros)
  fdp_stereo_add_ros_test(frame_processor ros)
  fdp_stereo_add_ros_test(search_range ros)
  fdp_stereo_add_ros_test(seed_conversions ros)
  fdp_stereo_add_ros_test(node_status ros)
  fdp_stereo_add_ros_test(periodic_task ros)
  fdp_stereo_add_ros_test(disparity_nodelet ros)
  fdp_stereo_add_ros_test(bad_input ros)
  fdp_stereo_add_ros_test(life_cycle ros)
  fdp_stereo_add_ros_test(sim_time ros)
  fdp_stereo_add_ros_test(points manager)
  fdp_stereo_add_ros_test(seeds ros)
  add_test(NAME master_gone COMMAND ${PROJECT_SOURCE_DIR}/test/ros/master_gone_test.sh ${CATKIN_DEVEL_PREFIX})
  set_tests_properties(master_gone PROPERTIES LABELS ros)
  add_test(NAME out_of_memory COMMAND ${PROJECT_SOURCE_DIR}/test/ros/out_of_memory_test.sh ${CATKIN_DEVEL_PREFIX})
  set_tests_properties(out_of_memory PROPERTIES LABELS manager) # sanitizers need all addresses
  add_test(NAME cfg_is_current COMMAND sh -c "$<TARGET_FILE:write_cfg> | diff ${PROJECT_SOURCE_DIR}/cfg/Disparity.cfg -")
  set_tests_properties(cfg_is_current PROPERTIES LABELS docs)
  add_dependencies(ros_tests disparity_node write_cfg)
  if(TARGET match) # these run command-line tools
    fdp_stereo_add_ros_test(recordings manager)
    add_test(NAME doctor COMMAND ${PROJECT_SOURCE_DIR}/test/ros/doctor_test.sh ${CATKIN_DEVEL_PREFIX})
    set_tests_properties(doctor PROPERTIES LABELS manager)
    add_dependencies(ros_tests doctor)
    fdp_stereo_add_ros_test(diagnosis ros)
    target_link_libraries(diagnosis_test PRIVATE fdp_stereo_diagnosis)
  endif()
  include(cmake/fdp_stereo_fuzz.cmake)
endif()
