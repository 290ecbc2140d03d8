#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# lint.sh [format|functions|shell|catkin|tidy|all [BUILD FOLDER]]: the linters that the tests run; needs scripts/setup.sh --test,
# and tidy a configured build folder (build/ by default).
set -euo pipefail
# shellcheck source=scripts/environment.sh
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"
cd "$FDP_STEREO_ROOT"
build="${2:-build}"

sources() { git ls-files -- 'include/*.hpp' 'src/*.[ch]pp' 'tools/*.[ch]pp' 'benchmark/*.[ch]pp' 'test/*.[ch]pp' \
  'examples/*.cpp'; }

lint_format() { sources | xargs clang-format --dry-run --Werror; }
# Of the core and the nodelet: 60 lines at most, half of all at most 8.
lint_functions() {
  git ls-files -- 'src/core/*.[ch]pp' 'src/ros/*.[ch]pp' |
    ctags -L - -x --languages=C++ --kinds-C++=f --_xformat='%{line} %{end} %{input}:%{line} %{name}' |
    awk '$2 { print $2 - $1 + 1, $3, $4 }' | sort -n | awk '
      { lines[NR] = $1 }
      $1 > 60 { print "lint.sh: function of " $1 " lines, 60 are allowed: " $2 " " $3; failed = 1 }
      END {
        median = lines[int((NR + 1) / 2)]
        print NR " functions, median " median ", longest " lines[NR] " lines"
        exit failed || NR == 0 || median > 8
      }'
}
lint_shell() { git ls-files -- 'scripts/*.sh' 'test/*.sh' .ci/run | xargs shellcheck -x; }
lint_catkin() { catkin_lint -W2 .; }
# Those of the given paths that the build compiles: one without ROS has no commands for src/ros.
compiled() { while read -r path; do ! grep -qF "\"$FDP_STEREO_ROOT/$path\"" "$build/compile_commands.json" || echo "$path"; done; }
lint_tidy() { git ls-files -- 'src/*.cpp' 'tools/*.cpp' 'examples/*.cpp' | compiled |
  nice -n 19 xargs -P "$(nproc)" -n 1 clang-tidy -p "$build" --quiet --header-filter="$FDP_STEREO_ROOT/(include|src|tools)/.*"; }

case "${1:-all}" in
  format | functions | shell | catkin | tidy) "lint_$1" ;;
  all) lint_format && lint_functions && lint_shell && lint_catkin && lint_tidy ;;
  *) echo "lint.sh: unknown check '$1', there are format, functions, shell, catkin, tidy, all" >&2; exit 2 ;;
esac
