#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# docs.sh [BUILD FOLDER]: builds the site from docs/ and the public headers into docs/html of the build folder (build/ by
# default); needs scripts/setup.sh --test. A warning of Doxygen is an error.
set -euo pipefail
# shellcheck source=scripts/environment.sh
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"
cd "$FDP_STEREO_ROOT"
output="${1:-build}/docs"
mkdir -p "$output"
{ cat Doxyfile; echo "OUTPUT_DIRECTORY = $output"; } | doxygen - 2>"$output/warnings.log"
if [ -s "$output/warnings.log" ]; then
  cat "$output/warnings.log" >&2
  exit 1
fi
echo "docs.sh: see $output/html/index.html"
