# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# cpack -G DEB, as scripts/package.sh calls it: a Debian package for /usr that brings what the demo needs.
set(CPACK_PACKAGE_NAME fdp-stereo)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "The fdp_stereo authors <maintainers@fdp-stereo.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Stereo matching for robots and for the shell (ROS 1 nodelet and tools)")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# The graph of the demo; libraries are found by dpkg-shlibdeps. Debian keeps package.xml and nodelet plugin files in the
# -dev packages, and roslaunch needs them.
string(CONCAT CPACK_DEBIAN_PACKAGE_DEPENDS
  "python3-roslaunch, rosbash, rosout, python3-rosbag, librosbag-dev, libnodelet-dev, libnodeletlib-dev, libnodeletlib-tools, "
  "python3-dynamic-reconfigure, python3-stereo-msgs, python3-diagnostic-msgs, libimage-proc-dev, ros-image-proc, "
  "libimage-transport-dev")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS rviz)
include(CPack)
