# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Command-line tools. With catkin they land in devel/lib/fdp_stereo, where rosrun finds them.
function(fdp_stereo_add_tool name)
  add_executable(${name} ${ARGN})
  target_link_libraries(${name} PRIVATE fdp_stereo_core CLI11::CLI11)
  if(CATKIN_DEVEL_PREFIX)
    set_target_properties(${name} PROPERTIES
      RUNTIME_OUTPUT_DIRECTORY ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION})
    install(TARGETS ${name} RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
  else()
    install(TARGETS ${name} RUNTIME DESTINATION bin)
  endif()
endfunction()

if(EXISTS ${PROJECT_SOURCE_DIR}/tools/match.cpp)
  fdp_stereo_add_tool(match tools/match.cpp)
endif()
