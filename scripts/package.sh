#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# package.sh: builds a Debian package for /usr in build-deb/ (fdp-stereo_VERSION_ARCHITECTURE.deb).
# Install it with: apt-get install ./build-deb/fdp-stereo_*.deb
set -euo pipefail
# shellcheck source=scripts/environment.sh
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"
cd "$FDP_STEREO_ROOT"
scripts/setup.sh
# CATKIN_BUILD_BINARY_PACKAGE leaves out the setup files of a workspace, which have no place in /usr.
cmake -S . -B build-deb -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX=/usr -DCATKIN_BUILD_BINARY_PACKAGE=ON \
  -DBUILD_TESTING=OFF
cmake --build build-deb
cd build-deb
cpack -G DEB
rm -r _CPack_Packages # roslaunch would find its launch files beside those of the sources
