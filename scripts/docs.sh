#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# docs.sh: builds the site from docs/ and the public headers into build/docs/html; needs scripts/setup.sh --test. A warning
# of Doxygen is an error.
set -euo pipefail
# shellcheck source=scripts/environment.sh
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"
cd "$FDP_STEREO_ROOT"
mkdir -p build/docs
doxygen Doxyfile 2>build/docs/warnings.log
if [ -s build/docs/warnings.log ]; then
  cat build/docs/warnings.log >&2
  exit 1
fi
echo "docs.sh: see build/docs/html/index.html"
