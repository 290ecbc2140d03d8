#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# fuzz.sh [SECONDS [RUNS]]: fuzzes messages, parameters and files, each for so long (default 600 s) or so many runs. A finding
# is left in build-fuzz/findings/ and ends the script with 1; new inputs that reach new code are added to
# test/fuzz/corpus/.
set -euo pipefail
# shellcheck source=scripts/environment.sh
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"
cd "$FDP_STEREO_ROOT"
scripts/setup.sh --test
cmake --preset fuzz
cmake --build build-fuzz --target fuzz_files fuzz_messages fuzz_parameters
mkdir -p build-fuzz/findings
# Leaks are what roscpp and OpenCV keep for the life of the process.
export ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1
for name in files messages parameters; do
  mkdir -p "build-fuzz/corpus/$name"
  "$(find build-fuzz -name "fuzz_$name" -type f -perm -u+x | head -n 1)" -max_total_time="${1:-600}" -runs="${2:--1}" \
    -timeout=20 -rss_limit_mb=2048 -max_len=8192 -print_final_stats=1 -artifact_prefix=build-fuzz/findings/ \
    "build-fuzz/corpus/$name" "test/fuzz/corpus/$name"
done
