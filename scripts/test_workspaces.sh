#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# test_workspaces.sh [--quick]: builds the last commit in a fresh workspace, once with catkin_make and once with
# catkin build, and runs the demo from each. --quick, which the tests run, only configures the sources as they are and
# generates a header. Needs scripts/setup.sh --test.
set -euo pipefail
# shellcheck source=scripts/environment.sh
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"
case "${1:-}" in
  "") quick=false ;;
  --quick) quick=true ;;
  *) echo "test_workspaces.sh: unknown option '$1', there is --quick" >&2; exit 2 ;;
esac

scratch="$(mktemp -d)"
trap 'rm -rf "$scratch"' EXIT
export ROS_HOME="$scratch/ros_home"
cmake_options=(-DCMAKE_BUILD_TYPE=Release)
targets=()
if $quick; then
  cmake_options+=(-DBUILD_TESTING=OFF)
  targets=(help) # which every configured package has
fi

new_workspace() {
  mkdir -p "$1/src"
  if $quick; then
    ln -s "$FDP_STEREO_ROOT" "$1/src/fdp_stereo"
  else
    git clone --quiet "$FDP_STEREO_ROOT" "$1/src/fdp_stereo"
  fi
}

build_with_catkin_make() {
  catkin_make -C "$1" "${targets[@]}" --cmake-args "${cmake_options[@]}"
}

build_with_catkin_build() {
  catkin init --workspace "$1"
  catkin build --workspace "$1" --no-status --no-color --cmake-args "${cmake_options[@]}" --make-args "${targets[@]}"
}

# The header of the parameters is generated into the devel space.
check_configuration() {
  local folder="$1/build"
  [ ! -f "$folder/fdp_stereo/CMakeCache.txt" ] || folder="$folder/fdp_stereo" # catkin build: one folder per package
  cmake --build "$folder" --target fdp_stereo_gencfg >/dev/null
  test -n "$(find "$1/build" "$1/devel" -name DisparityConfig.h)"
}

# The programs and the nodelet are found, and the demo runs, from the devel space of the workspace.
check_workspace() (
  set +u # catkin's file reads variables that may be unset
  # shellcheck source=/dev/null
  . "$1/devel/setup.bash"
  set -u
  rosrun fdp_stereo match --help >/dev/null
  roslaunch -p 11412 fdp_stereo demo.launch "output:=$1/output" </dev/null >"$1/roslaunch.log" 2>&1 || true
  grep -E '^disparity images out: +[1-9]' "$1/output/summary.txt"
)

for tool in catkin_make catkin_build; do
  workspace="$scratch/$tool"
  mkdir -p "$workspace/output"
  new_workspace "$workspace"
  if ! "build_with_$tool" "$workspace" >"$workspace/build.log" 2>&1; then
    tail -n 40 "$workspace/build.log" >&2
    echo "test_workspaces.sh: $tool failed" >&2
    exit 1
  fi
  if $quick; then
    check_configuration "$workspace"
  else
    check_workspace "$workspace"
  fi
  echo "test_workspaces.sh: $tool works"
done
