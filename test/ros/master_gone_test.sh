#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# master_gone_test.sh DEVEL: the ROS master dies and comes back; the node lives on and says so.
set -euo pipefail
export PATH="/usr/bin:/bin:$PATH"
set +u
# shellcheck source=/dev/null
. "$1/setup.bash"
set -u
port=11417
work="$(mktemp -d)"
export ROS_MASTER_URI="http://localhost:$port" ROS_HOME="$work"
trap 'kill "${node:-}" "${master:-}" 2>/dev/null || true; rm -rf "$work"' EXIT

start_master() {
  rosmaster --core -p "$port" </dev/null >"$work/master.log" 2>&1 &
  master=$!
  for _ in $(seq 200); do
    if rosparam list >/dev/null 2>&1; then return; fi
    sleep 0.1
  done
  echo "the master does not start" >&2
  exit 1
}
wait_for() {
  for _ in $(seq 300); do
    if grep -q "$1" "$work/node.log"; then return; fi
    kill -0 "$node" || { echo "the node died" >&2; cat "$work/node.log"; exit 1; }
    sleep 0.1
  done
  echo "not said: $1" >&2
  cat "$work/node.log" >&2
  exit 1
}

start_master
rosparam set /disparity/watch_period 0.2
"$1/lib/fdp_stereo/disparity_node" </dev/null >"$work/node.log" 2>&1 &
node=$!
for _ in $(seq 200); do
  if rosparam get /disparity/min_disparity >/dev/null 2>&1; then break; fi
  sleep 0.1
done
kill "$master"
wait "$master" || true
wait_for 'the ROS master does not answer'
start_master
wait_for 'the ROS master is back'
kill -0 "$node"
kill "$node"
wait "$node" || true
echo "passed"
