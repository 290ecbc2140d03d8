#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# latency.sh: how long a live edit takes while the preset accurate runs, and how old a disparity is at 30 and 200 Hz of
# input while fast runs.
set -euo pipefail
# shellcheck source=scripts/environment.sh
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"
cd "$FDP_STEREO_ROOT"
scripts/setup.sh --test
scripts/build.sh
set +u # catkin's file reads variables that may be unset
# shellcheck source=/dev/null
. build/devel/setup.bash
set -u
export ROS_HOME="$FDP_STEREO_ROOT/build/ros_home"
for setting in "accurate 10 100" "fast 30 0" "fast 200 0"; do
  read -r preset rate edits <<<"$setting"
  roslaunch -p 11413 fdp_stereo latency.launch preset:="$preset" rate:="$rate" edits:="$edits" </dev/null 2>&1 |
    grep -E '^(edit|output|preset)' || true
done
