#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes README's picture from the sample and its results table from scenes beside the repository.

    scripts/update_readme.py [--data FOLDER] [--presets fast paper accurate]

Needs a build (scripts/build.sh). The table names the commit and the processor that it was measured with.
"""
import argparse
import csv
import os
import re
import subprocess
import tempfile

import cv2
import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
BIN = os.path.join(ROOT, "build", "devel", "lib", "fdp_stereo")
SETS = (("MiddEval3-trainingQ", "Middlebury V3, 8 scenes at quarter size"),
        ("Middlebury-v2", "Middlebury 2001/2003, 4 scenes"),
        ("KITTI2012", "KITTI 2012, 8 scenes"))
NAMES = {"sgbm_hh": "OpenCV StereoSGBM, MODE_HH", "sgbm_3way": "OpenCV StereoSGBM, MODE_SGBM_3WAY", "bm": "OpenCV StereoBM"}
COLUMNS = (("bad_0.125", "bad .125"), ("bad_0.5", "bad .5"), ("bad_1", "bad 1"), ("bad_2", "bad 2"),
           ("average_px", "avg px"), ("time_ms", "ms"), ("cpu_ms", "CPU ms"), ("memory_mb", "MB"))
HALF = {"PianoL", "Playroom", "Playtable", "Shelves", "Vintage"}


def make_picture():
    sample = os.path.join(ROOT, "sample", "motorcycle")
    with tempfile.TemporaryDirectory() as folder:
        color = os.path.join(folder, "color.png")
        subprocess.run([os.path.join(BIN, "match"), sample + "/left.png", sample + "/right.png", "--num-disparities", "64",
                        "--output", os.path.join(folder, "d.pfm"), "--color", color], check=True, stdout=subprocess.DEVNULL)
        beside = np.hstack([cv2.imread(sample + "/left.png"), cv2.imread(color)])
    picture = os.path.join(ROOT, "docs", "images", "motorcycle.png")
    cv2.imwrite(picture, cv2.resize(beside, None, fx=0.6, fy=0.6, interpolation=cv2.INTER_AREA))


def averages(table):
    """Weighted mean of every column per method, in the order of the table."""
    with open(table, newline="") as file:
        rows = list(csv.DictReader(file))
    means = {}
    for method in dict.fromkeys(row["method"] for row in rows):
        own = [row for row in rows if row["method"] == method]
        weights = [0.5 if row["scene"] in HALF else 1.0 for row in own]
        means[method] = {name: np.average([float(row[name] or "nan") for row in own], weights=weights)
                         for name, _ in COLUMNS}
    return means


def table_of(command, heading):
    with tempfile.TemporaryDirectory() as folder:
        table = os.path.join(folder, "table.csv")
        subprocess.run(command + ["--csv", table], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        means = averages(table)
    best = {name: min(mean[name] for mean in means.values()) for name, _ in COLUMNS}
    lines = ["", "| %s | %s |" % (heading, " | ".join(text for _, text in COLUMNS)), "|---" * (len(COLUMNS) + 1) + "|"]
    for method, mean in means.items():
        cells = []
        for name, _ in COLUMNS:
            text = "%.0f" % mean[name] if name in ("time_ms", "cpu_ms", "memory_mb") else "%.2f" % mean[name]
            cells.append("**%s**" % text if mean[name] == best[name] else text)
        lines.append("| %s | %s |" % (NAMES.get(method, "`%s`" % method), " | ".join(cells)))
    return lines


def machine():
    with open("/proc/cpuinfo") as file:
        model = next((line.split(":", 1)[1].strip() for line in file if line.startswith("model name")), "unknown processor")
    return "%s, %d threads" % (model, os.cpu_count())


def commit():
    """The commit that is checked out, and whether the programs were changed since."""
    git = ["git", "-C", ROOT]
    name = subprocess.run(git + ["rev-parse", "--short", "HEAD"], check=True, stdout=subprocess.PIPE, text=True).stdout.strip()
    changed = subprocess.run(git + ["diff", "--quiet", "HEAD", "--", "include", "src", "tools", "config"]).returncode != 0
    return name + (" with local changes" if changed else "")


def make_results(data, presets):
    lines = ['Columns "bad t": share in % of the pixels whose disparity is off by more than t px, among the pixels that both cameras see;',
             "holes are filled, means are weighted as in the Middlebury V3 table. ms, CPU ms: wall and CPU time of one run per",
             "pair (docs/performance.md has medians); MB: memory of the run. Bold: the best of a column. Measured at commit %s on %s."
             % (commit(), machine())]
    for folder, heading in SETS:
        if not os.path.isdir(os.path.join(data, folder)):
            continue
        words = [os.path.join("build", "devel", "lib", "fdp_stereo", "evaluate"), os.path.join(data, folder), "--fill", "--peers"]
        for preset in presets:
            words += ["--preset", preset]
        lines += table_of(words, heading)
        lines += ["", "<!-- skip: needs the scenes -->", "```bash", " ".join(words), "```"]
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", default="../shared/data", help="folder of the scene folders (default: %(default)s)")
    parser.add_argument("--presets", nargs="+", default=["fast", "accurate", "paper"])
    arguments = parser.parse_args()
    os.chdir(ROOT)
    make_picture()
    results = "\n".join(["<!-- results -->"] + make_results(arguments.data, arguments.presets) + ["<!-- /results -->"])
    with open("README.md") as file:
        text = file.read()
    with open("README.md", "w") as file:
        file.write(re.sub("<!-- results -->.*<!-- /results -->", lambda _: results, text, flags=re.S))


if __name__ == "__main__":
    main()
