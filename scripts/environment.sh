# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash
#
# Sourced by the other scripts. Debian's ROS 1 needs Debian's own python3, so the system's folders come first on PATH.
export PATH="/usr/bin:/bin:/usr/sbin:/sbin:$PATH"
FDP_STEREO_ROOT="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
export FDP_STEREO_ROOT
