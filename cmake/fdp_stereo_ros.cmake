# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# The nodelet and its tools. Everything but what needs a node is tested without a roscore.
add_library(fdp_stereo_nodelet
  src/ros/camera.cpp
  src/ros/conversions.cpp
  src/ros/search_range.cpp
  src/ros/node_params.cpp
  src/ros/params_ros.cpp
  src/ros/reconfigure_server.cpp
  src/ros/pair_synchronizer.cpp
  src/ros/seed_conversions.cpp
  src/ros/seed_sources.cpp
  src/ros/mask_sources.cpp
  src/ros/rectifier.cpp
  src/ros/deadline_controller.cpp
  src/ros/frame_processor.cpp
  src/ros/output_topics.cpp
  src/ros/node_status.cpp
  src/ros/node_reporter.cpp
  src/ros/periodic_task.cpp
  src/ros/thread_priority.cpp
  src/ros/point_frame.cpp
  src/ros/point_messages.cpp
  src/ros/point_params.cpp
  src/ros/disparity_nodelet.cpp
  src/ros/points_nodelet.cpp
)
add_dependencies(fdp_stereo_nodelet ${PROJECT_NAME}_gencfg)
target_include_directories(fdp_stereo_nodelet PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src/ros>)
target_include_directories(fdp_stereo_nodelet SYSTEM PUBLIC ${catkin_INCLUDE_DIRS})
target_link_libraries(fdp_stereo_nodelet PUBLIC fdp_stereo_core ${catkin_LIBRARIES} PRIVATE OpenMP::OpenMP_CXX)
if(NOT CMAKE_CXX_FLAGS MATCHES "-fsanitize") # whose symbols clang leaves to the executable
  target_link_options(fdp_stereo_nodelet PRIVATE -Wl,--no-undefined)
endif()

# The same as a plain node.
add_executable(disparity_node src/ros/disparity_node.cpp)
target_include_directories(disparity_node PRIVATE include)
target_include_directories(disparity_node SYSTEM PRIVATE ${catkin_INCLUDE_DIRS})
target_link_libraries(disparity_node PRIVATE ${catkin_LIBRARIES})
set_target_properties(disparity_node PROPERTIES
  RUNTIME_OUTPUT_DIRECTORY ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION})
add_dependencies(disparity_node fdp_stereo_nodelet)

if(TARGET match)
  add_library(fdp_stereo_bags STATIC
    tools/bag_pairs.cpp
    tools/bag_topics.cpp
    tools/calibration_file.cpp
    tools/compressed_image.cpp
  )
  target_link_libraries(fdp_stereo_bags PUBLIC fdp_stereo_nodelet fdp_stereo_tool_support PRIVATE ${YAML_CPP_LIBRARIES})
  foreach(tool images_to_bag process_bag)
    fdp_stereo_add_tool(${tool} tools/${tool}.cpp)
    target_link_libraries(${tool} PRIVATE fdp_stereo_bags)
  endforeach()
  fdp_stereo_add_tool(range tools/range.cpp)
  target_link_libraries(range PRIVATE fdp_stereo_nodelet)
  foreach(tool demo_report doctor latency_probe)
    fdp_stereo_add_tool(${tool} tools/${tool}.cpp)
    target_compile_definitions(${tool} PRIVATE FDP_STEREO_VERSION="${PROJECT_VERSION}")
    target_link_libraries(${tool} PRIVATE fdp_stereo_nodelet)
  endforeach()
  add_library(fdp_stereo_diagnosis STATIC tools/diagnosis.cpp)
  target_include_directories(fdp_stereo_diagnosis PUBLIC ${PROJECT_SOURCE_DIR}/tools)
  target_link_libraries(fdp_stereo_diagnosis PUBLIC fdp_stereo_nodelet)
  target_link_libraries(doctor PRIVATE fdp_stereo_diagnosis)

  # The sample recording, from the pair in sample/.
  set(_sample ${PROJECT_SOURCE_DIR}/sample/motorcycle)
  set(_sample_bag ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_SHARE_DESTINATION}/sample/motorcycle.bag)
  add_custom_command(OUTPUT ${_sample_bag}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_SHARE_DESTINATION}/sample
    COMMAND images_to_bag --left ${_sample}/left.png --right ${_sample}/right.png --left-info ${_sample}/left.yaml
            --right-info ${_sample}/right.yaml --rate 2 --repeat 16 --output ${_sample_bag} --overwrite
    DEPENDS images_to_bag ${_sample}/left.png ${_sample}/right.png ${_sample}/left.yaml ${_sample}/right.yaml)
  add_custom_target(sample_bag ALL DEPENDS ${_sample_bag})
  install(FILES ${_sample_bag} sample/README.md sample/motorcycle/LICENSE.txt
    DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION}/sample)
endif()

# cfg/Disparity.cfg follows the list of parameters: build this target after a change there.
add_executable(write_cfg EXCLUDE_FROM_ALL tools/write_cfg.cpp)
target_link_libraries(write_cfg PRIVATE fdp_stereo_nodelet)
add_custom_target(update_cfg COMMAND write_cfg > ${PROJECT_SOURCE_DIR}/cfg/Disparity.cfg VERBATIM)

install(TARGETS disparity_node RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(FILES nodelet_plugins.xml DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
install(DIRECTORY launch config cfg rviz DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
install(TARGETS fdp_stereo_nodelet
  ARCHIVE DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  RUNTIME DESTINATION ${CATKIN_GLOBAL_BIN_DESTINATION})
