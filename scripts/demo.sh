#!/bin/bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Installs what is missing, builds, and plays a recording of a stereo camera through the graph, headless.
# usage: scripts/demo.sh [BAG]   (default: the sample recording)
# Leaves demo_output/: disparity.png (left image beside the disparity), output.bag, summary.txt.
# Ends with 0 only if disparity images arrived.
set -euo pipefail
cd "$(dirname "$0")/.."
export PATH=/usr/bin:/bin:/usr/sbin:/sbin

scripts/setup.sh
scripts/build.sh
set +u
. build/devel/setup.bash
set -u

output=$PWD/demo_output
bag=$(realpath "${1:-build/devel/share/fdp_stereo/sample/motorcycle.bag}")
rm -rf "$output"
mkdir -p "$output"
export ROS_HOME=$output/ros_home
export ROS_MASTER_URI=http://localhost:${FDP_STEREO_DEMO_PORT:-11411}

color=true
# A grey camera has no colour to use.
if rosbag info -y -k topics "$bag" >/dev/null && ! /usr/bin/python3 - "$bag" <<'PYTHON'
import sys
import rosbag
message = next(rosbag.Bag(sys.argv[1]).read_messages(topics=["/stereo/left/image_raw"])).message
sys.exit(message.encoding in ("mono8", "mono16"))
PYTHON
then
  color=false
fi

status=0
roslaunch -p "${ROS_MASTER_URI##*:}" fdp_stereo demo.launch bag:="$bag" output:="$output" color:=$color \
  </dev/null >"$output/roslaunch.log" 2>&1 || status=$?

if [ ! -s "$output/summary.txt" ]; then
  echo "demo: no summary was written; the end of $output/roslaunch.log:" >&2
  tail -20 "$output/roslaunch.log" >&2
  exit 1
fi
cat "$output/summary.txt"
echo "See $output: disparity.png, output.bag, summary.txt, roslaunch.log"
grep -Eq '^disparity images out: +[1-9]' "$output/summary.txt"
