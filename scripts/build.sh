#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# build.sh [CMAKE OPTION...]: builds everything but the tests in Release mode into build/. The programs land in
# build/devel/lib/fdp_stereo/; cmake --install build puts the package into build/.install (hidden: roslaunch searches
# all other folders of the repository and would find every file twice) unless another -DCMAKE_INSTALL_PREFIX=... is given.
set -euo pipefail
# shellcheck source=scripts/environment.sh
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"
cd "$FDP_STEREO_ROOT"
cmake -S . -B build -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$PWD/build/.install" "$@"
cmake --build build
