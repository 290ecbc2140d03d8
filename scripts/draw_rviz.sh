#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# draw_rviz.sh [FILE]: docs/images/rviz.jpg (or FILE), the window of rviz as `stereo.launch rviz:=true` opens it, with the
# sample recording; no screen is needed. Needs a build and Debian's rviz, xvfb, libgl1-mesa-dri and python3-pil.
set -euo pipefail
# shellcheck source=scripts/environment.sh
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"
cd "$FDP_STEREO_ROOT"
picture="$(realpath -m "${1:-docs/images/rviz.jpg}")"
set +u # catkin's file reads variables that may be unset
# shellcheck source=/dev/null
. build/devel/setup.bash
set -u
work="$(mktemp -d)"
export ROS_HOME="$work" ROS_LOG_DIR="$work" ROS_MASTER_URI=http://localhost:11423 DISPLAY=:97 LIBGL_ALWAYS_SOFTWARE=1
trap 'jobs -p | xargs -r kill 2>/dev/null || true; wait; rm -rf "$work"' EXIT
Xvfb "$DISPLAY" -screen 0 1280x800x24 >"$work/x.log" 2>&1 &
roslaunch -p 11423 fdp_stereo stereo.launch __ns:=stereo rviz:=true disparity_range:=64 </dev/null >"$work/launch.log" 2>&1 &
for _ in $(seq 60); do
  if rosnode list 2>/dev/null | grep -q rviz; then break; fi
  sleep 1
done
rosbag play -q -l build/devel/share/fdp_stereo/sample/motorcycle.bag </dev/null >"$work/play.log" 2>&1 &
rostopic echo -n 8 /stereo/disparity/header >/dev/null
sleep 10
python3 -c "import sys; from PIL import ImageGrab; ImageGrab.grab(xdisplay='$DISPLAY').save(sys.argv[1])" "$picture"
echo "$picture"
