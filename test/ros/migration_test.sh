#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# migration_test.sh DEVEL: the launch file and the parameters of stereo_image_proc, moved by docs/migration.md alone, run
# without a warning; parameters that are not moved are told in one.
# shellcheck source=test/ros/launched.sh
. "$(dirname "${BASH_SOURCE[0]}")/launched.sh" "$1"
page="$(dirname "${BASH_SOURCE[0]}")/../../docs/migration.md"

# block LANGUAGE NUMBER: of the page's blocks in this language, the first is 1.
block() {
  awk -v begin="\`\`\`$1" -v number="$2" '
    /^```/ && inside { inside = 0; next }
    $0 == begin { inside = 1; ++count; next }
    inside && count == number' "$page"
}

start_master
play
block xml 2 >"$work/moved.launch"
block yaml 2 >"$work/stereo.yaml"
launch "$work/moved.launch"
expect_message /stereo/disparity
expect_message /stereo/points2
expect_warnings 0
[ "$(rosparam get /stereo/disparity/disparity_range)" = 64 ]
stop_all

play
block yaml 1 >"$work/stereo.yaml"
launch "$work/moved.launch"
expect_message /stereo/disparity
expect_warnings 1
for name in stereo_algorithm prefilter_size prefilter_cap correlation_window_size texture_threshold fullDP P1 P2; do
  grep -q "WARN.*'$name' (" "$work/said" || fail "$name is not told"
done
stop_all
echo "passed"
