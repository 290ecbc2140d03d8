#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# latency.sh [PAIRS [DEADLINE]]: how long a live edit takes while the preset accurate runs; how old a disparity is at 30 and
# 200 Hz of input while fast runs; how long a VGA pair takes from its messages to its disparity, beside the core alone on
# the same pair (median of 40 pairs in turns), with the nodelet in the camera's process and as a node of its own; how long
# a raw pair takes that the node rectifies, or image_proc before it; and what deadline_ms (default 150) does at 5 Hz while
# other work takes half of the cores, and after it.
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
measure() {
  roslaunch -p 11413 fdp_stereo latency.launch "$@" </dev/null 2>&1 | grep -E '^(edit|output|pair|preset|raw|deadline)' || true
}
measure preset:=accurate rate:=10 edits:=100 width:=160 height:=120
measure preset:=fast rate:=30
measure preset:=fast rate:=200
for inside in true false; do
  measure preset:=fast width:=640 height:=480 range:=96 pairs:="${1:-40}" inside:=$inside
done
measure rectify:=true width:=640 height:=480 range:=96 pairs:="${1:-40}"
measure rate:=5 seconds:=40 width:=640 height:=480 range:=96 deadline:="${2:-150}"
