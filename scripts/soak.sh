#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# soak.sh [FRAMES]: so many pairs (default 10000) at full speed through the nodelet; the memory must not grow by 2 MB
# after frame 500. The short form of this is in the tests.
set -euo pipefail
# shellcheck source=scripts/environment.sh
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"
cd "$FDP_STEREO_ROOT"
scripts/setup.sh --test
scripts/build.sh
cmake --build build --target life_cycle_test
set +u # catkin's file reads variables that may be unset
# shellcheck source=/dev/null
. build/devel/setup.bash
set -u
export ROS_HOME="$FDP_STEREO_ROOT/build/ros_home"
log="$FDP_STEREO_ROOT/build/soak.log"
FDP_STEREO_SOAK_FRAMES="${1:-10000}" FDP_STEREO_FILTER='LifeCycle.SoakDoesNotGrow' \
  rostest --text test/ros/life_cycle.test </dev/null >"$log" 2>&1 || true
grep -E 'frames, RSS|Failure' "$log" || true
grep -qF '[  PASSED  ] 1 test' "$log" || { echo "soak.sh: failed, see $log" >&2; exit 1; }
