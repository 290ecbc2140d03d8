#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# recipes_test.sh DEVEL: the recipes whose packages are here, with the sample recording. Each must run without a warning.
# shellcheck source=test/ros/launched.sh
. "$(dirname "${BASH_SOURCE[0]}")/launched.sh" "$1"
recipes="$(cd "$(dirname "${BASH_SOURCE[0]}")/../../launch/recipes" && pwd)"
start_master

echo "bag"
launch "$recipes/bag.launch" play_args:=--loop
expect_message /stereo/disparity
expect_message /stereo/points2
expect_warnings 0
stop_all
rosparam set use_sim_time false

echo "compressed, with images that are not"
play /stereo/left/image_raw:=/robot/stereo/left/image_raw /stereo/left/camera_info:=/robot/stereo/left/camera_info \
  /stereo/right/image_raw:=/robot/stereo/right/image_raw /stereo/right/camera_info:=/robot/stereo/right/camera_info
launch "$recipes/compressed.launch" transport:=raw
expect_message /stereo/disparity
expect_warnings 0
stop_all

echo "two cameras"
play /stereo/left/image_raw:=/front/left/image_raw /stereo/left/camera_info:=/front/left/camera_info \
  /stereo/right/image_raw:=/front/right/image_raw /stereo/right/camera_info:=/front/right/camera_info
front="$played"
play /stereo/left/image_raw:=/rear/left/image_raw /stereo/left/camera_info:=/rear/left/camera_info \
  /stereo/right/image_raw:=/rear/right/image_raw /stereo/right/camera_info:=/rear/right/camera_info
launch "$recipes/two_cameras.launch"
expect_message /front/disparity
expect_message /rear/disparity
expect_warnings 0
[ "$(rosparam get /rear/disparity/threads)" = 1 ]
kill -INT "$front"
stop_all

echo "tune, save, load; record and reprocess"
play
launch fdp_stereo stereo.launch __ns:=stereo
expect_message /stereo/disparity
rosrun dynamic_reconfigure dynparam set /stereo/disparity speckle_size 123 >/dev/null
rosrun dynamic_reconfigure dynparam dump /stereo/disparity "$work/tuned.yaml" >/dev/null
tuning="$launched"
launch "$recipes/record.launch" output:="$work/recorded.bag"
sleep 8
kill -INT "$launched"
wait "$launched" || true
launched="$tuning"
stop_all
rosbag info "$work/recorded.bag" >"$work/said" || fail "no recording"
"$1/lib/fdp_stereo/process_bag" "$work/recorded.bag" "$work/processed.bag" --rectify --preset "$work/tuned.yaml" \
  >"$work/said" 2>&1 || fail "process_bag refuses the recording"
play
launch fdp_stereo stereo.launch __ns:=stereo params:="$work/tuned.yaml"
expect_message /stereo/disparity
expect_warnings 0
[ "$(rosparam get /stereo/disparity/speckle_size)" = 123 ]
stop_all
echo "passed"
