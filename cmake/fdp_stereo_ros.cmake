# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# The nodelet and its tools. Everything but the topics (disparity_nodelet.cpp) is tested without a roscore.
add_library(fdp_stereo_nodelet
  src/ros/conversions.cpp
)
target_include_directories(fdp_stereo_nodelet PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src/ros>)
target_include_directories(fdp_stereo_nodelet SYSTEM PUBLIC ${catkin_INCLUDE_DIRS})
target_link_libraries(fdp_stereo_nodelet PUBLIC fdp_stereo_core ${catkin_LIBRARIES} PRIVATE OpenMP::OpenMP_CXX)
target_link_options(fdp_stereo_nodelet PRIVATE -Wl,--no-undefined)
install(TARGETS fdp_stereo_core fdp_stereo_nodelet
  ARCHIVE DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  RUNTIME DESTINATION ${CATKIN_GLOBAL_BIN_DESTINATION})
install(DIRECTORY include/fdp_stereo/ DESTINATION ${CATKIN_PACKAGE_INCLUDE_DESTINATION})
