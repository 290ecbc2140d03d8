#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# setup.sh [--test]: installs what Debian 12 lacks to build and run the package, as root or with sudo. --test adds
# what the tests, the linters and the sanitizer builds need. Does nothing where all is there.
set -euo pipefail
# shellcheck source=scripts/environment.sh
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

build_packages=(
  g++ cmake ninja-build git dpkg-dev file
  libopencv-dev libeigen3-dev libyaml-cpp-dev libcli11-dev nlohmann-json3-dev
  catkin libroscpp-dev libnodelet-dev libnodeletlib-dev libnodeletlib-tools libimage-transport-dev libcv-bridge-dev
  libimage-geometry-dev libstereo-msgs-dev libsensor-msgs-dev libmessage-filters-dev libtf2-ros-dev
  libdynamic-reconfigure-config-init-mutex-dev python3-dynamic-reconfigure libdiagnostic-updater-dev librosbag-dev
)
run_packages=(
  python3-roslaunch rosbash rosout python3-rosbag python3-rostopic python3-rosnode python3-rosparam
  python3-stereo-msgs python3-sensor-msgs python3-diagnostic-msgs python3-numpy python3-cv-bridge python3-opencv
  image-transport-tools topic-tools libimage-proc-dev ros-image-proc libstereo-image-proc-dev ros-stereo-image-proc
)
test_packages=(
  libgtest-dev libbenchmark-dev librostest-dev python3-rostest python3-tf2-ros
  clang clang-format clang-tidy universal-ctags libomp-dev libclang-rt-dev shellcheck catkin-lint catkin-tools
  chromium chromium-driver doxygen graphviz liboctomap-dev parallel
)

# What some releases lack: without CLI11 there are no command-line tools.
optional_packages=(libcli11-dev catkin-tools libclang-rt-dev)

packages=("${build_packages[@]}" "${run_packages[@]}")
for argument in "$@"; do
  case "$argument" in
    --test) packages+=("${test_packages[@]}") ;;
    *) echo "setup.sh: unknown option '$argument', there is --test" >&2; exit 2 ;;
  esac
done

# ROS asks for localhost; a root without /etc/hosts does not know it.
getent hosts localhost >/dev/null || packages+=(libnss-myhostname)

missing=()
for package in "${packages[@]}"; do
  status="$(dpkg-query -W -f='${Status}' "$package" 2>/dev/null || true)"
  [ "$status" = "install ok installed" ] || missing+=("$package")
done
if [ "${#missing[@]}" -eq 0 ]; then
  exit 0
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "setup.sh: run as root or install sudo, to install ${missing[*]}" >&2; exit 1; }
  as_root=(sudo)
fi
echo "setup.sh: installing ${missing[*]}"
"${as_root[@]}" apt-get update -q
available=()
for package in "${missing[@]}"; do
  if [[ " ${optional_packages[*]} " == *" $package "* ]] && ! apt-cache show "$package" >/dev/null 2>&1; then
    echo "setup.sh: this release has no $package"
  else
    available+=("$package")
  fi
done
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${available[@]}"
