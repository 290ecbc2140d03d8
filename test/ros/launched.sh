# shellcheck shell=bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# For tests of launch files beside a recording that plays, sourced as: launched.sh DEVEL.
# shellcheck source=test/ros/own_master.sh
. "$(dirname "${BASH_SOURCE[0]}")/own_master.sh" "$1"
bag="$1/share/fdp_stereo/sample/motorcycle.bag"
played="" # empty where the launch file plays by itself

# launch ARGUMENT...: starts roslaunch, its log is $work/said.
launch() {
  roslaunch "$@" </dev/null >"$work/said" 2>&1 &
  launched=$!
}

# play ARGUMENT...: the sample, again and again.
# shellcheck disable=SC2120 # without arguments it plays as it is
play() {
  rosbag play -q -l "$bag" "$@" </dev/null >"$work/played" 2>&1 &
  played=$!
}

fail() {
  echo "$1" >&2
  cat "$work/said" >&2
  exit 1
}

# expect_message TOPIC: something comes within two minutes.
expect_message() {
  timeout 120 rostopic echo -n 1 --noarr "$1" </dev/null >"$work/message" 2>&1 || fail "nothing on $1"
  [ -s "$work/message" ] || fail "nothing on $1"
}

# expect_warnings COUNT
expect_warnings() {
  [ "$(grep -cE '\[ ?(WARN|ERROR|FATAL)\]' "$work/said")" -eq "$1" ] || fail "not $1 warnings"
}

stop_all() {
  local jobs=("$launched")
  [ -z "$played" ] || jobs+=("$played")
  kill -INT "${jobs[@]}"
  wait "${jobs[@]}" || true
  played=""
}
