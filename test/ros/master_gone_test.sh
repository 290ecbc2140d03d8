#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# master_gone_test.sh DEVEL: the ROS master dies and comes back; the node lives on and says so.
# shellcheck source=test/ros/own_master.sh
. "$(dirname "${BASH_SOURCE[0]}")/own_master.sh" "$1"

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
  if rostopic list 2>/dev/null | grep -qx /disparity_color; then break; fi # the last that it advertises
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
