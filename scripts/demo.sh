#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# demo.sh [BAG]: installs what is missing, builds, and plays a recording of a stereo camera (the sample by default)
# through rectification, disparity, depth and points, without a screen.
# Leaves demo_output/: disparity.png (left image beside the disparity), output.bag, summary.txt, roslaunch.log.
# Ends with 0 only if disparity images arrived.
set -euo pipefail
# shellcheck source=scripts/environment.sh
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"
bag="${1:+$(realpath "$1")}"
cd "$FDP_STEREO_ROOT"
scripts/setup.sh
scripts/build.sh
set +u # catkin's file reads variables that may be unset
# shellcheck source=/dev/null
. build/devel/setup.bash
set -u

bag="${bag:-$FDP_STEREO_ROOT/build/devel/share/fdp_stereo/sample/motorcycle.bag}"
output="$FDP_STEREO_ROOT/demo_output"
port="${FDP_STEREO_DEMO_PORT:-11411}"
rm -rf "$output"
mkdir -p "$output"
export ROS_HOME="$output/ros_home"
export ROS_MASTER_URI="http://localhost:$port"

is_color() {
  python3 - "$1" <<'PYTHON'
import sys
import rosbag

for _, message, _ in rosbag.Bag(sys.argv[1]).read_messages(topics=["/stereo/left/image_raw"]):
    sys.exit(0 if message.encoding not in ("mono8", "mono16") else 1)
sys.exit(sys.argv[1] + ": no images on /stereo/left/image_raw")
PYTHON
}
if is_color "$bag"; then color=true; else color=false; fi

roslaunch -p "$port" fdp_stereo demo.launch bag:="$bag" output:="$output" color:="$color" \
  </dev/null >"$output/roslaunch.log" 2>&1 || true

if [ ! -s "$output/summary.txt" ]; then
  echo "demo.sh: no summary came out; the end of $output/roslaunch.log:" >&2
  tail -n 20 "$output/roslaunch.log" >&2
  exit 1
fi
cat "$output/summary.txt"
echo "See $output: disparity.png, output.bag, summary.txt, roslaunch.log"
grep -Eq '^disparity images out: +[1-9]' "$output/summary.txt"
