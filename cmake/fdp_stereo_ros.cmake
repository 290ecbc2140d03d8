# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# The nodelet and its tools. Everything but the topics (disparity_nodelet.cpp) is tested without a roscore.
add_library(fdp_stereo_nodelet
  src/ros/conversions.cpp
  src/ros/params_ros.cpp
  src/ros/reconfigure_server.cpp
  src/ros/frame_worker.cpp
  src/ros/frame_processor.cpp
  src/ros/node_status.cpp
  src/ros/thread_priority.cpp
  src/ros/disparity_nodelet.cpp
)
add_dependencies(fdp_stereo_nodelet ${PROJECT_NAME}_gencfg)
target_include_directories(fdp_stereo_nodelet PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src/ros>)
target_include_directories(fdp_stereo_nodelet SYSTEM PUBLIC ${catkin_INCLUDE_DIRS})
target_link_libraries(fdp_stereo_nodelet PUBLIC fdp_stereo_core ${catkin_LIBRARIES} PRIVATE OpenMP::OpenMP_CXX)
target_link_options(fdp_stereo_nodelet PRIVATE -Wl,--no-undefined)

# The same as a plain node.
add_executable(disparity_node src/ros/disparity_node.cpp)
target_include_directories(disparity_node SYSTEM PRIVATE ${catkin_INCLUDE_DIRS})
target_link_libraries(disparity_node PRIVATE ${catkin_LIBRARIES})
set_target_properties(disparity_node PROPERTIES
  RUNTIME_OUTPUT_DIRECTORY ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION})
add_dependencies(disparity_node fdp_stereo_nodelet)

# cfg/Disparity.cfg follows the list of parameters: build this target after a change there.
add_executable(write_cfg EXCLUDE_FROM_ALL src/ros/write_cfg.cpp)
target_link_libraries(write_cfg PRIVATE fdp_stereo_nodelet)
add_custom_target(update_cfg COMMAND write_cfg ${PROJECT_SOURCE_DIR}/cfg/Disparity.cfg)

install(TARGETS disparity_node RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(FILES nodelet_plugins.xml DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
install(TARGETS fdp_stereo_core fdp_stereo_nodelet
  ARCHIVE DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  RUNTIME DESTINATION ${CATKIN_GLOBAL_BIN_DESTINATION})
install(DIRECTORY include/fdp_stereo/ DESTINATION ${CATKIN_PACKAGE_INCLUDE_DESTINATION})
