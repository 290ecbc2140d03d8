# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Installs the core for find_package(fdp_stereo), which gives the target fdp_stereo::core. With catkin its own package
# file includes ours (cmake/fdp_stereo_catkin.cmake).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
if(FDP_STEREO_ROS)
  set(FDP_STEREO_LIB_DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION})
  set(FDP_STEREO_BIN_DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
  set(_config_destination ${CATKIN_PACKAGE_SHARE_DESTINATION}/cmake)
  # Packages of one workspace see each other before anything is installed.
  export(TARGETS fdp_stereo_core NAMESPACE fdp_stereo::
    FILE ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_SHARE_DESTINATION}/cmake/fdp_stereoTargets.cmake)
else()
  set(FDP_STEREO_LIB_DESTINATION ${CMAKE_INSTALL_LIBDIR})
  set(FDP_STEREO_BIN_DESTINATION ${CMAKE_INSTALL_BINDIR})
  set(_config_destination ${CMAKE_INSTALL_LIBDIR}/cmake/fdp_stereo)
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/fdp_stereoConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  configure_file(cmake/fdp_stereo-extras.cmake ${PROJECT_BINARY_DIR}/fdp_stereoConfig.cmake COPYONLY)
  #catkin_lint: ignore_once missing_file
  install(FILES ${PROJECT_BINARY_DIR}/fdp_stereoConfig.cmake ${PROJECT_BINARY_DIR}/fdp_stereoConfigVersion.cmake
    DESTINATION ${_config_destination})
endif()
# Programs and the nodelet find the core wherever the prefix is.
file(RELATIVE_PATH _lib_from_bin /prefix/${FDP_STEREO_BIN_DESTINATION} /prefix/${FDP_STEREO_LIB_DESTINATION})
set(CMAKE_INSTALL_RPATH "$ORIGIN" "$ORIGIN/${_lib_from_bin}")

install(TARGETS fdp_stereo_core EXPORT fdp_stereoTargets
  ARCHIVE DESTINATION ${FDP_STEREO_LIB_DESTINATION}
  LIBRARY DESTINATION ${FDP_STEREO_LIB_DESTINATION}
  RUNTIME DESTINATION ${FDP_STEREO_BIN_DESTINATION}
  INCLUDES DESTINATION include)
install(EXPORT fdp_stereoTargets NAMESPACE fdp_stereo:: DESTINATION ${_config_destination})
install(DIRECTORY include/fdp_stereo DESTINATION include)
