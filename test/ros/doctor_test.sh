#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# doctor_test.sh DEVEL: doctor.launch beside a node and a recording that plays: all well, exchanged images, a throttled
# camera. It ends by itself and without calling that a death.
# shellcheck source=test/ros/own_master.sh
. "$(dirname "${BASH_SOURCE[0]}")/own_master.sh" "$1"
bag="$1/share/fdp_stereo/sample/motorcycle.bag"

start_master
ROS_NAMESPACE=stereo "$1/lib/fdp_stereo/disparity_node" left/image_rect:=left/image_raw right/image_rect:=right/image_raw \
  </dev/null >"$work/node.log" 2>&1 &

play() {
  rosbag play -q -l "$bag" "$@" </dev/null >/dev/null 2>&1 &
  play=$!
}
stop() {
  kill -INT "$1"
  wait "$1" || true
}
# ask EXPECTED [ARGUMENT...]: doctor.launch says EXPECTED and ends with exit code 0.
ask() {
  local expected="$1"
  shift
  timeout 600 roslaunch fdp_stereo doctor.launch image:=image_raw seconds:=8 "$@" </dev/null >"$work/said" 2>&1 ||
    { echo "roslaunch: exit code $?" >&2; cat "$work/said" >&2; exit 1; }
  if ! grep -qE "$expected" "$work/said" || grep -q 'REQUIRED' "$work/said"; then
    echo "expected: $expected" >&2
    cat "$work/said" >&2
    exit 1
  fi
}

play
ask '^good +disparity: '
if grep -qE 'WRONG|has died' "$work/said"; then cat "$work/said" >&2; exit 1; fi
rosrun topic_tools throttle messages /stereo/right/image_raw 1 /stereo/slow/image_raw </dev/null >/dev/null 2>&1 &
throttle=$!
rosrun topic_tools throttle messages /stereo/right/camera_info 1 /stereo/slow/camera_info </dev/null >/dev/null 2>&1 &
slow_info=$!
ask '^odd +the rates differ: .* of /stereo/slow/image_raw' right:=slow
stop "$throttle"
stop "$slow_info"
stop "$play"
play /stereo/left/image_raw:=/stereo/right/image_raw /stereo/right/image_raw:=/stereo/left/image_raw
ask '^WRONG +left and right images are swapped'
stop "$play"
echo "passed"
