#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes docs/tuning.md and its pictures from the sample pair: each case is run with the settings that it shows.

    scripts/update_tuning.py [--output FOLDER]

Needs a build (scripts/build.sh). FOLDER is docs by default.
"""
import argparse
import os
import subprocess
import tempfile

import cv2
import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
MATCH = os.environ.get("FDP_STEREO_BIN", os.path.join(ROOT, "build", "devel", "lib", "fdp_stereo")) + "/match"
SAMPLE = os.path.join(ROOT, "sample", "motorcycle")

WHOLE = (0, 0, 741, 500)
SEAT = (60, 100, 296, 200)
ROW_SHIFT_PX = 2.0  # of the right image in the case "rows": a camera that was knocked

# name, symptom, remedy, part of the picture (x, y, width, height), settings before, settings after
CASES = (
    ("range", "Near things are wrong or missing, far ones are right",
     "The searched range ends before the disparities of near things. Raise `search.num_disparities` (`disparity_range` in "
     "ROS): a thing at a distance of Z metres has a disparity of f T / Z px, with the focal length f in px and the baseline T "
     "in metres. A smaller range is faster and leaves fewer candidates to confuse, so choose it just large enough.",
     WHOLE, {"search.num_disparities": "40"}, {"search.num_disparities": "64"}),
    ("rows", "Noise and holes everywhere, horizontal edges worst, on cameras that were calibrated long ago",
     "The same point does not lie on the same row of both images (here the right image is shifted by 2 px). Switch "
     "`row_alignment.enabled` on. `match --row-alignment FILE` draws how far the rows are off, and the node warns when it is "
     "more than `row_alignment.warn_px`; then calibrate the cameras again.",
     WHOLE, {"row_alignment.enabled": "false"}, {"row_alignment.enabled": "true"}),
    ("smoothness", "Streaks in places with weak texture",
     "The penalties for changes of the disparity are too small for the matching cost. Raise `semi_global.p1` and "
     "`semi_global.p2`, p2 to about five times p1.",
     WHOLE, {"semi_global.p1": "0.05", "semi_global.p2": "0.2"}, {"semi_global.p1": "0.6", "semi_global.p2": "2.7"}),
    ("left_right", "Wrong disparities to the left of near things",
     "Only the left camera sees that part of the background. Switch `left_right_check.enabled` on, which removes such pixels; "
     "a smaller `left_right_check.max_difference_px` is stricter.",
     WHOLE, {"left_right_check.enabled": "false", "speckle_filter.max_size": "0"},
     {"left_right_check.enabled": "true", "speckle_filter.max_size": "0"}),
    ("speckles", "Small islands of wrong disparities",
     "Raise `speckle_filter.max_size` (`speckle_size` in ROS): connected regions with fewer pixels than that are removed. "
     "If it is too large, thin things are removed too.",
     SEAT, {"speckle_filter.max_size": "0"}, {"speckle_filter.max_size": "300"}),
    ("uniqueness", "Too many holes",
     "Lower `semi_global.uniqueness_ratio` (`uniqueness_ratio` in ROS), or raise `left_right_check.max_difference_px`. To "
     "plan the path of a robot, holes are better than guesses; for a picture, fill them.",
     WHOLE, {"semi_global.uniqueness_ratio": "40"}, {"semi_global.uniqueness_ratio": "0"}),
    ("filling", "Every pixel must have a value",
     "Switch `hole_filling.enabled` on (`--fill` on the command line). Pixels without disparity then get that of the "
     "background beside them, which is a guess.",
     WHOLE, {"hole_filling.enabled": "false"}, {"hole_filling.enabled": "true"}),
)

HEAD = """# Choosing good stereo parameters

Every section shows a symptom, the parameter that helps, and the disparity before and after the change; black is no disparity. All
other parameters are those of the preset `fast`. On a robot, parameters can be changed while the node runs, with
`rqt_reconfigure`. Their names in ROS have `_` instead of the dot, or are those of stereo_image_proc; YAML files and `--set` take
both. [parameters.md](parameters.md) lists them all.

The window of `rqt_reconfigure` shows what matters first, in the order in which one tunes; the groups below are closed until their
box is ticked:

| group | what it holds |
|---|---|
| `basic_1_search` | `preset`, the range, the scale of the images, the repair of rows |
| `basic_2_smoothness` | the optimiser and its penalties |
| `basic_3_filters` | what is removed, filled and smoothed |
| `basic_4_seeds` | how far seeds are believed |
| `basic_5_node` | rate and limits of the depth |
| `expert_01_pipeline`, ... | the rest, stage by stage |

![Five open groups of parameters with sliders, and the closed groups of experts below](images/tuning_window.svg)

(Drawn by `scripts/draw_tuning_window.py` from `cfg/Disparity.cfg`, which rqt_reconfigure shows.)

Choose a `preset` there to begin again; it turns to `custom` with the first value that is changed. When the values are good, keep them:
`rosrun dynamic_reconfigure dynparam dump /stereo/disparity tuned.yaml`. The file is a preset for the tools and `params:=tuned.yaml`
of `stereo.launch`.

Work in this order: first calibration and rows, then the range, then the matching cost and the penalties, and last what is removed
and what is filled.

This page is made by `scripts/update_tuning.py` from the sample pair; do not edit it by hand.
"""


def picture(settings, part, row_shift_px):
    """A part of the coloured disparity of the sample pair under some settings, 444 x 300."""
    words = ["--set=%s=%s" % item for item in settings.items()]
    if "search.num_disparities" not in settings:
        words.append("--set=search.num_disparities=64")
    with tempfile.TemporaryDirectory() as folder:
        color = os.path.join(folder, "color.png")
        right = cv2.imread(SAMPLE + "/right.png")
        shift = np.float32([[1, 0, 0], [0, 1, row_shift_px]])
        cv2.imwrite(os.path.join(folder, "right.png"),
                    cv2.warpAffine(right, shift, right.shape[1::-1], flags=cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE))
        subprocess.run([MATCH, SAMPLE + "/left.png", os.path.join(folder, "right.png"), "-o", os.path.join(folder, "d.pfm"),
                        "--color", color] + words, check=True, stdout=subprocess.DEVNULL)
        x, y, width, height = part
        return cv2.resize(cv2.imread(color)[y:y + height, x:x + width], (444, 300), interpolation=cv2.INTER_AREA)


def text(settings):
    return ", ".join("`%s=%s`" % item for item in settings.items())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", default=os.path.join(ROOT, "docs"))
    output = parser.parse_args().output
    os.makedirs(os.path.join(output, "images"), exist_ok=True)
    page = HEAD
    for name, symptom, remedy, part, before, after in CASES:
        shift = ROW_SHIFT_PX if name == "rows" else 0.0
        gap = np.full((300, 6, 3), 255, np.uint8)
        beside = np.hstack([picture(before, part, shift), gap, picture(after, part, shift)])
        file = "images/tuning_%s.jpg" % name
        cv2.imwrite(os.path.join(output, file), beside, [cv2.IMWRITE_JPEG_QUALITY, 88])
        page += "\n## %s\n\n%s\n\n![%s: before and after](%s)\n\n%s, then %s.\n" % (
            symptom, remedy, symptom, file, text(before), text(after))
    with open(os.path.join(output, "tuning.md"), "w") as file:
        file.write(page)


if __name__ == "__main__":
    main()
