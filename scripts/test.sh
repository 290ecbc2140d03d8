#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# test.sh: installs what is missing, builds, and runs every test (gtest, rostest, scripts, documents) and the linters.
# The last line is "N passed, M failed"; the exit code is 0 only if none failed.
set -euo pipefail
# shellcheck source=scripts/environment.sh
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"
cd "$FDP_STEREO_ROOT"
scripts/setup.sh --test
scripts/build.sh
cmake --build build --target tests

# roscpp and rosbag read standard input; a CI machine may have none worth reading. Tests of nodes wait more than they
# compute: clang-tidy takes what they leave.
report=build/ctest.log
ROS_HOME="$PWD/build/ros_home" ctest --test-dir build --output-on-failure -j "$(nproc)" </dev/null 2>&1 | tee "$report" || true

total="$(sed -n 's/.* tests failed out of \([0-9]*\).*/\1/p' "$report" | tail -n 1)"
failed="$(sed -n 's/.*% tests passed, \([0-9]*\) tests failed out of.*/\1/p' "$report" | tail -n 1)"
if [ -z "$total" ] || [ "$total" -eq 0 ]; then
  echo "test.sh: no test ran" >&2
  echo "0 passed, 1 failed"
  exit 1
fi
echo "$((total - failed)) passed, $failed failed"
[ "$failed" -eq 0 ]
