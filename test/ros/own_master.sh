# shellcheck shell=bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# For tests with a ROS master of their own, sourced as: own_master.sh DEVEL. Makes the folder $work for logs and
# start_master; at the end, all background jobs end and $work goes.
set -euo pipefail
export PATH="/usr/bin:/bin:$PATH"
set +u
# shellcheck source=/dev/null
. "$1/setup.bash"
set -u
work="$(mktemp -d)"
export PYTHONUNBUFFERED=1 # what a program in the background prints can be read at once
port=$((12000 + $$ % 20000)) # another one for each test that runs, below those that connections get
export ROS_MASTER_URI="http://localhost:$port" ROS_HOME="$work" ROS_LOG_DIR="$work"
trap 'jobs -p | xargs -r kill 2>/dev/null || true; rm -rf "$work"' EXIT

start_master() {
  rosmaster --core -p "${ROS_MASTER_URI##*:}" </dev/null >"$work/master.log" 2>&1 &
  # shellcheck disable=SC2034 # used by what sources this
  master=$!
  for _ in $(seq 200); do
    if rosparam list >/dev/null 2>&1; then return; fi
    sleep 0.1
  done
  echo "the master does not start" >&2
  exit 1
}
