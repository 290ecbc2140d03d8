#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# train_cost.sh FOLDER: trains the network of a learned matching cost and writes FOLDER/cost_network.txt. Photos and
# programs come from Debian packages; the photos' licences are in training/photos.py. Fixed seeds, at most 2 hours.
set -euo pipefail
# shellcheck source=scripts/environment.sh
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"
[ $# -eq 1 ] || { echo "usage: train_cost.sh FOLDER" >&2; exit 2; }
python3 -c 'import cv2, numpy, torch' 2>/dev/null ||
  { echo "train_cost.sh: apt-get install python3-torch python3-opencv python3-numpy" >&2; exit 1; }
mkdir -p "$1"
cd "$1"
for package in lomiri-wallpapers-16.04 python3-skimage python3-sklearn python3-scipy; do
  compgen -G "${package}_*.deb" >/dev/null || apt-get download "$package"
  dpkg -x "${package}"_*.deb photos
done
python3 "$FDP_STEREO_ROOT/training/train.py" photos cost_network.txt | tee training.log
