#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# fuzz.sh [--keep] [SECONDS [RUNS]]: fuzzes files, messages and parameters one after the other, each for so long (default
# 600 s) or so many runs. A finding is left in build-fuzz/findings/ and ends the script with 1: put it into
# test/fuzz/corpus/, whose files the tests replay. Inputs that reach new code are collected in build-fuzz/corpus/;
# --keep takes the fewest that reach all of it into test/fuzz/corpus/.
set -euo pipefail
# shellcheck source=scripts/environment.sh
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"
cd "$FDP_STEREO_ROOT"
keep=false
if [ "${1:-}" = --keep ]; then
  keep=true
  shift
fi
seconds="${1:-600}"
runs="${2:--1}"
scripts/setup.sh --test
cmake --preset fuzz
cmake --build build-fuzz --target fuzz_files fuzz_messages fuzz_parameters
mkdir -p build-fuzz/findings
# Leaks are what roscpp and OpenCV keep for the life of the process.
export ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1:malloc_context_size=4
export OPENCV_LOG_LEVEL=SILENT
options=(-timeout=20 -rss_limit_mb=2048 -max_len=4096 -artifact_prefix=build-fuzz/findings/)

for name in files messages parameters; do
  fuzzer="build-fuzz/devel/lib/fdp_stereo/fuzz_$name"
  mkdir -p "build-fuzz/corpus/$name"
  log="build-fuzz/$name.log"
  echo "fuzz.sh: $name for $seconds s, log in $log"
  if ! "$fuzzer" "${options[@]}" -max_total_time="$seconds" -runs="$runs" -print_final_stats=1 \
    "build-fuzz/corpus/$name" "test/fuzz/corpus/$name" >"$log" 2>&1; then
    tail -n 40 "$log" >&2
    echo "fuzz.sh: a finding in $name, see build-fuzz/findings/" >&2
    exit 1
  fi
  grep -aE '^stat::(number_of_executed_units|average_exec_per_sec)' "$log"
  if $keep; then
    "$fuzzer" "${options[@]}" -set_cover_merge=1 "test/fuzz/corpus/$name" "build-fuzz/corpus/$name" >>"$log" 2>&1
  fi
done
