#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# benchmark.sh [--json FILE] [--methods LIST] [--runs N] [--threads N] [SCENE ...]: builds the benchmark and compares
# the presets with OpenCV's matchers, taking turns in one process: median of 7 runs, 2 threads. Without a scene: the
# sample and, where they are present, those of ../shared/data. The presets accurate and paper take most of the time:
# `--methods fast,sgbm_hh,sgbm_3way,bm` leaves them out.
# benchmark.sh --scaling [--preset NAME] [--runs N]: the CPU time with 1, 2, 4 and 8 threads, the critical path through it,
# and how much faster that makes a machine with as many cores, measured by the clocks of the threads: two cores are enough.
set -euo pipefail
# shellcheck source=scripts/environment.sh
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

program=compare
options=()
scenes=()
while [ $# -gt 0 ]; do
  case "$1" in
    --json) options+=(--json "$(realpath -m "${2:?--json needs a file}")") && shift 2 ;;
    --scaling) program=threads && shift ;;
    -h | --help) options+=("$1") && shift ;;
    --*=*) options+=("$1") && shift ;;
    --*) options+=("$1" "${2:?$1 needs a value}") && shift 2 ;;
    *) scenes+=("$(realpath "$1")") && shift ;;
  esac
done

cd "$FDP_STEREO_ROOT"
if [ "$program" = threads ]; then
  [ ${#scenes[@]} -eq 0 ] || { echo "benchmark.sh: --scaling measures the sample, it takes no scene" >&2; exit 2; }
  scenes=(sample/motorcycle/left.png sample/motorcycle/right.png)
elif [ ${#scenes[@]} -eq 0 ]; then
  scenes=(sample/motorcycle)
  for folder in MiddEval3-trainingQ Middlebury-v2 KITTI2012; do
    [ ! -d "../shared/data/$folder" ] || scenes+=("../shared/data/$folder")
  done
fi
scripts/setup.sh >&2
[ -f build/CMakeCache.txt ] || cmake -S . -B build -G Ninja -DCMAKE_BUILD_TYPE=Release >&2
cmake --build build --target "$program" >&2

# Threads that wait must not count as CPU time.
export OMP_WAIT_POLICY="${OMP_WAIT_POLICY:-passive}"
exec "build/benchmark/$program" "${options[@]}" "${scenes[@]}"
