#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the figures of README and docs/performance.md anew from docs/measured.json, which scripts/measure.py made.

    scripts/update_readme.py [--check | --picture]

--check changes nothing and fails where a figure differs; --picture makes README's picture from the sample, too (needs a build).
"""
import argparse
import json
import math
import os
import re
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
BIN = os.path.join(ROOT, "build", "devel", "lib", "fdp_stereo")
SETS = (("MiddEval3-trainingQ", "Middlebury V3 at quarter size"), ("Middlebury-v2", "Middlebury 2001/2003"),
        ("Middlebury-2005-2006", "Middlebury 2005/2006"),
        ("KITTI2012", "KITTI 2012"))
NAMES = {"fast": "`fast`", "light": "`light`", "accurate": "`accurate`, offline", "sgbm_hh": "StereoSGBM, MODE_HH",
         "sgbm_3way": "StereoSGBM, MODE_SGBM_3WAY", "bm": "StereoBM"}
COLUMNS = (("bad_0.5", "bad .5"), ("bad_1", "bad 1"), ("bad_2", "bad 2"), ("bad_3", "bad 3"), ("d1", "D1"),
           ("average_px", "avg px"), ("a95_px", "A95 px"), ("answered", "answered %"), ("wrong", "wrong of answered %"), ("memory_mb", "MB"))
BLOCK = "<!-- %s -->.*?<!-- /%s -->"


def summary(measured):
    """README's sentence."""
    scenes = measured["accuracy"]["MiddEval3-trainingQ"]
    speed = measured["speed"]["cpu_ms"]["640 x 480 x 64"]
    bad = {method: "%.1f %%" % scenes[method]["bad_1"] for method in ("fast", "sgbm_hh", "sgbm_3way", "bm")}
    return [("**%s of the pixels are wrong by more than 1 px** with the preset `fast`, %s with OpenCV's StereoSGBM (%s in its fast "
             "mode) and %s with StereoBM: Middlebury V3, %d scenes, holes filled. It takes %.1f times the CPU time of StereoSGBM's fast "
             "mode; the preset `light` takes %.1f times.")
            % (bad["fast"], bad["sgbm_hh"], bad["sgbm_3way"], bad["bm"], scenes["fast"]["scenes"],
               speed["fast"] / speed["sgbm_3way"], speed["light"] / speed["sgbm_3way"])]


def accuracy_table(entries, heading):
    columns = [(name, text) for name, text in COLUMNS if any(name in entry for entry in entries.values())]
    best = {name: (max if name == "answered" else min)(entry[name] for entry in entries.values() if name in entry)
            for name, _ in columns}
    lines = ["| %s, %d scenes | %s | commit |" % (heading, next(iter(entries.values()))["scenes"],
                                                  " | ".join(text for _, text in columns)),
             "|---" * (len(columns) + 2) + "|"]
    for method in sorted(entries, key=list(NAMES).index):
        cells = []
        for name, _ in columns:
            value = entries[method].get(name)
            text = "-" if value is None else "%.0f" % value if name == "memory_mb" else "%.2f" % value
            cells.append("**%s**" % text if value == best[name] else text)
        lines.append("| %s | %s | %s |" % (NAMES[method], " | ".join(cells), entries[method]["commit"]))
    return lines + [""]


def accuracy(measured):
    lines = []
    for folder, heading in SETS:
        if folder in measured["accuracy"]:
            lines += accuracy_table(measured["accuracy"][folder], heading)
    return lines[:-1]


def speed(measured):
    table = measured["speed"]
    methods = ("bm", "sgbm_3way", "light", "fast")
    lines = ["| CPU ms per frame (Hz of one core) | %s |" % " | ".join(NAMES[method] for method in methods), "|---" * 5 + "|"]
    for size in sorted(table["cpu_ms"], key=lambda size: math.prod(map(int, size.split(" x ")))):
        times = table["cpu_ms"][size]
        cells = ["%.0f (%.1f)" % (times[method], 1e3 / times[method]) for method in methods]
        lines.append("| %s | %s |" % (size, " | ".join(cells)))
    for folder, heading in SETS:
        entries = measured["accuracy"].get(folder, {})
        for name, text in (("answered", "answered %"), ("wrong", "wrong of answered %"), ("bad_1", "bad 1, filled")):
            if entries:
                lines.append("| %s: %s | %s |" % (heading, text, " | ".join("%.1f" % entries[method][name] for method in methods)))
    note = "Times: %s, one thread, median of %d, commit %s." % (table["machine"], table["runs"], table["commit"])
    if table["load"] > table["cores"]:
        note += " The machine did other work meanwhile (load %.0f on %d cores): compare the columns, not the milliseconds." % (
            table["load"], table["cores"])
    return lines + ["", note]


def metres(measured):
    methods = ("bm", "sgbm_3way", "light", "fast")
    lines = ["| RMS error of the depth (answered) at | %s |" % " | ".join(NAMES[method] for method in methods), "|---" * 5 + "|"]
    for distance, entry in sorted(measured["metres"]["rms_m"].items(), key=lambda item: float(item[0])):
        cells = ["%.3f m (%.0f %%)" % (entry[method], entry[method + "_answered"]) for method in methods]
        lines.append("| %s m | %s |" % (distance, " | ".join(cells)))
    return lines


PAGES = {"README.md": {"summary": summary}, "docs/performance.md": {"accuracy": accuracy, "speed": speed, "metres": metres}}


def rendered(page, measured):
    with open(os.path.join(ROOT, page)) as file:
        text = file.read()
    for name, make in PAGES[page].items():
        block = "\n".join(["<!-- %s -->" % name, *make(measured), "<!-- /%s -->" % name])
        text, count = re.subn(BLOCK % (name, name), lambda _, block=block: block, text, flags=re.S)
        if count != 1:
            sys.exit("update_readme.py: %s needs one block <!-- %s -->" % (page, name))
    return text


def update(measured, check):
    """The pages that differ."""
    differing = []
    for page in PAGES:
        path = os.path.join(ROOT, page)
        text = rendered(page, measured)
        with open(path) as file:
            if file.read() == text:
                continue
        differing.append(page)
        if not check:
            with open(path, "w") as file:
                file.write(text)
    return differing


def make_picture():
    import cv2
    import numpy as np
    sample = os.path.join(ROOT, "sample", "motorcycle")
    with tempfile.TemporaryDirectory() as folder:
        color = os.path.join(folder, "color.png")
        subprocess.run([os.path.join(BIN, "match"), sample + "/left.png", sample + "/right.png", "--num-disparities", "64",
                        "--output", os.path.join(folder, "d.pfm"), "--color", color], check=True, stdout=subprocess.DEVNULL)
        beside = np.hstack([cv2.imread(sample + "/left.png"), cv2.imread(color)])
    picture = os.path.join(ROOT, "docs", "images", "motorcycle.png")
    cv2.imwrite(picture, cv2.resize(beside, None, fx=0.6, fy=0.6, interpolation=cv2.INTER_AREA))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--picture", action="store_true")
    options = parser.parse_args()
    if options.picture:
        make_picture()
    with open(os.path.join(ROOT, "docs", "measured.json")) as file:
        differing = update(json.load(file), options.check)
    if options.check and differing:
        sys.exit("update_readme.py: %s: figures differ from docs/measured.json; measure again (scripts/measure.py) instead of "
                 "editing them" % ", ".join(differing))


if __name__ == "__main__":
    main()
