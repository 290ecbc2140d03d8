#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# test_platform.sh NAME: builds and tests the sources as they are in a root of their own. Needs root and an archive of
# Debian among apt's sources.
#   debian-13  everything, and all tests but the linters, which are bound to one version
#   debian-11  library and nodelet (no command-line tools: that release has no CLI11), and the golden checksums
#   arm64      the library without ROS, cross-built; its kernels consist of vector instructions; the core's tests under
#              qemu, the golden checksums among them
#   bare       no package of ROS: the library is built and installed there, and the example built against it and run
# The root is made in a temporary folder and removed; with FDP_STEREO_ROOTS=FOLDER it stays there and is used again.
set -euo pipefail
# shellcheck source=scripts/environment.sh
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

say() { echo "test_platform.sh: $*"; }
fail() { echo "test_platform.sh: $1" >&2; exit "${2:-1}"; }

name="${1:-}"
case "$name" in
  debian-13) suite=trixie ;;
  debian-11) suite=bullseye ;;
  arm64 | bare) suite=bookworm ;;
  *) fail "unknown platform '$name', there are debian-13, debian-11, arm64, bare" 2 ;;
esac
[ "$(id -u)" -eq 0 ] || fail "run as root: debootstrap and chroot need it"
command -v debootstrap >/dev/null || { apt-get update -q && apt-get install -y -q --no-install-recommends debootstrap; }

if [ -n "${FDP_STEREO_ROOTS:-}" ]; then
  root="$(realpath -m "$FDP_STEREO_ROOTS")/$name"
  case "$root" in "$FDP_STEREO_ROOT"/*) fail "FDP_STEREO_ROOTS is inside the repository: choose a folder outside" 2 ;; esac
  remove=false
else
  root="$(mktemp -d)/$name"
  remove=true
fi
mkdir -p "$root"

leave() {
  umount "$root/dev/pts" "$root/proc" 2>/dev/null || true
  if $remove; then rm -rf --one-file-system "$(dirname "$root")"; fi
}
trap leave EXIT

inside() { chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 CI=true "$@"; }

make_root() {
  if [ -e "$root/made" ]; then
    say "using $suite in $root"
    return
  fi
  local mirror
  # shellcheck disable=SC2016 # apt's own format
  mirror="$(apt-get indextargets 'Created-By: Packages' 'Label: Debian' --format '$(SITE)' | sed -n 1p)"
  [ -n "$mirror" ] || fail "apt's sources name no archive of Debian"
  say "making $suite in $root"
  debootstrap --variant=minbase "$suite" "$root" "$mirror" >"$root.log" 2>&1 || { tail "$root.log" >&2; exit 1; }
  touch "$root/made"
}

# The times of the files are those here: what a run before built from others would pass for up to date.
copy_sources() {
  rm -rf "$root/fdp_stereo" "$root/build"
  mkdir "$root/fdp_stereo"
  git -C "$FDP_STEREO_ROOT" ls-files -co --exclude-standard -z |
    tar -C "$FDP_STEREO_ROOT" --null --ignore-failed-read -T - -cf - 2>/dev/null | tar -C "$root/fdp_stereo" -xf -
}

setup() { inside env DEBIAN_FRONTEND=noninteractive /fdp_stereo/scripts/setup.sh "$@" >>"$root.log"; }
install_packages() { inside env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "$@" >>"$root.log"; }

build() { # TARGET OF THE TESTS, CMAKE OPTION...
  local tests="$1"
  shift
  say "building with $(inside "${compiler:-g++}" --version | sed -n 1p) and OpenCV $(inside sh -c \
    "sed -n 's/^SET(OpenCV_VERSION \([0-9.]*\)).*/\1/p' /usr/lib/*/cmake/opencv4/OpenCVConfig.cmake")"
  inside cmake -S /fdp_stereo -B /build -G Ninja -DCMAKE_BUILD_TYPE=Release "$@" >"$root.log"
  inside cmake --build /build --target all "$tests"
}

run_tests() { # CTEST OPTION...
  say "running ctest $*"
  inside sh -c 'cd /build && ROS_HOSTNAME=localhost ROS_HOME=/build/ros_home exec ctest --output-on-failure "$@"' ctest "$@" </dev/null
}

test_debian_13() {
  setup --test
  build tests
  run_tests -LE lint
}

test_debian_11() {
  setup
  install_packages libgtest-dev
  build golden_test
  run_tests -R golden
}

test_arm64() {
  inside dpkg --add-architecture arm64
  inside apt-get update -q >>"$root.log"
  install_packages g++-aarch64-linux-gnu cmake ninja-build python3 qemu-user-static libeigen3-dev libcli11-dev \
    libopencv-dev:arm64 libyaml-cpp-dev:arm64 libgtest-dev:arm64 libgomp1:arm64
  compiler=aarch64-linux-gnu-g++
  build core_tests -DFDP_STEREO_ROS=OFF -DCMAKE_TOOLCHAIN_FILE=/fdp_stereo/cmake/toolchains/aarch64-linux-gnu.cmake
  inside env OBJDUMP=aarch64-linux-gnu-objdump sh -c \
    '/fdp_stereo/scripts/check_vector_code.sh /build/CMakeFiles/fdp_stereo_core_kernels_baseline.dir/src/core/simd/*.o'
  run_tests -L core -j "$(nproc)"
}

test_bare() {
  install_packages g++ cmake ninja-build libopencv-dev libeigen3-dev libyaml-cpp-dev
  # shellcheck disable=SC2016 # dpkg's own format
  if inside dpkg-query -W -f='${Package}\n' | grep -E '^(lib)?(ros|catkin)' >&2; then fail "the root has packages of ROS"; fi
  build all -DFDP_STEREO_ROS=OFF -DBUILD_TESTING=OFF
  inside cmake --install /build --prefix /prefix >>"$root.log"
  inside cmake -S /fdp_stereo/examples -B /example -G Ninja -DCMAKE_PREFIX_PATH=/prefix >>"$root.log"
  inside cmake --build /example
  inside /example/match_two_images /fdp_stereo/sample/motorcycle/left.png /fdp_stereo/sample/motorcycle/right.png /disparity.pfm
  say "the example wrote $(inside wc -c /disparity.pfm)"
}

make_root
mountpoint -q "$root/proc" || mount -t proc proc "$root/proc"
mountpoint -q "$root/dev/pts" || mount -t devpts -o newinstance,ptmxmode=0666 devpts "$root/dev/pts" # catkin build opens one
copy_sources
case "$name" in
  debian-13) test_debian_13 ;;
  debian-11) test_debian_11 ;;
  arm64) test_arm64 ;;
  bare) test_bare ;;
esac
say "$name passed"
