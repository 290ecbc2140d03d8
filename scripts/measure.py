#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""Measures what README and docs/performance.md tell, and writes it to docs/measured.json.

    scripts/measure.py accuracy [--data FOLDER] [--methods fast light sgbm_hh ...] [--sets NAME ...]
    scripts/measure.py speed [--runs N]
    scripts/measure.py metres

Replaces what was measured again and keeps the rest; every entry names its commit. Then run scripts/update_readme.py. Needs a
build (scripts/build.sh).
"""
import argparse
import csv
import json
import math
import os
import statistics
import subprocess
import tempfile

import cv2
import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
MEASURED = os.path.join(ROOT, "docs", "measured.json")
EVALUATE = os.path.join(ROOT, "build", "devel", "lib", "fdp_stereo", "evaluate")
MATCH = os.path.join(os.path.dirname(EVALUATE), "match")
SETS = ("MiddEval3-trainingQ", "Middlebury-v2", "Middlebury-2005-2006", "KITTI2012")
PEERS = ("sgbm_hh", "sgbm_3way", "bm")
PROGRAMS = ("include", "src", "tools", "config")
SIZES = ((640, 480, 64), (640, 480, 96), (1280, 720, 128), (1226, 370, 128))
HALF = {"PianoL", "Playroom", "Playtable", "Shelves", "Vintage"}  # weights of the Middlebury V3 table


def commit():
    """The last commit that changed the programs, and whether they were changed since."""
    git = ["git", "-C", ROOT]
    name = subprocess.run(git + ["log", "-1", "--format=%h", "--", *PROGRAMS], check=True, stdout=subprocess.PIPE,
                          text=True).stdout.strip()
    changed = subprocess.run(git + ["diff", "--quiet", "HEAD", "--", *PROGRAMS]).returncode != 0
    return name + (" with local changes" if changed else "")


def machine():
    with open("/proc/cpuinfo") as file:
        return next((line.split(":", 1)[1].strip() for line in file if line.startswith("model name")), "unknown processor")


def evaluate(folder, methods, fill, *more):
    """Rows per method."""
    command = [EVALUATE, folder, *more] + (["--fill"] if fill else []) + (["--peers"] if set(methods) & set(PEERS) else [])
    for preset in [name for name in methods if name not in PEERS] or ["light"]:
        command += ["--preset", preset]
    with tempfile.TemporaryDirectory() as work:
        table = os.path.join(work, "table.csv")
        subprocess.run(command + ["--csv", table], check=True, stdout=subprocess.DEVNULL,
                       env=dict(os.environ, OMP_WAIT_POLICY="passive"))
        with open(table, newline="") as file:
            rows = list(csv.DictReader(file))
    return {method: [row for row in rows if row["method"] == method] for method in methods}


def mean(rows, value):
    return float(np.average([value(row) for row in rows], weights=[0.5 if row["scene"] in HALF else 1.0 for row in rows]))


def wrong_of_answered(row):
    """% of the answered pixels that are off by more than 1 px; a pixel without answer counts as bad in bad_1."""
    answered = float(row["density"])
    return 100.0 * (float(row["bad_1"]) - (100.0 - answered)) / answered


def write(measured):
    with open(MEASURED, "w") as file:
        json.dump(measured, file, indent=1, sort_keys=True)
        file.write("\n")


def measure_accuracy(measured, options):
    for name in options.sets:
        folder = os.path.join(options.data, name)
        filled, answered = (evaluate(folder, options.methods, fill) for fill in (True, False))
        for method in options.methods:
            rows = filled[method]
            columns = [column for column in rows[0] if column.startswith("bad_") or column in ("d1", "average_px", "a95_px")]
            entry = {column: mean(rows, lambda row, column=column: float(row[column])) for column in columns}
            entry["memory_mb"] = mean(rows, lambda row: float(row["memory_mb"]))
            entry["answered"] = mean(answered[method], lambda row: float(row["density"]))
            entry["wrong"] = mean(answered[method], wrong_of_answered)
            entry["scenes"], entry["commit"] = len(rows), commit()
            measured.setdefault("accuracy", {}).setdefault(name, {})[method] = entry
        write(measured)


def write_scene(folder, width, height, disparities):
    """The sample in another size, with a truth that only makes it a scene: its errors mean nothing."""
    os.makedirs(folder)
    for name, side in (("im0", "left"), ("im1", "right")):
        image = cv2.imread(os.path.join(ROOT, "sample", "motorcycle", side + ".png"))
        cv2.imwrite(os.path.join(folder, name + ".png"), cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA))
    with open(os.path.join(folder, "disp0GT.pfm"), "wb") as file:
        file.write(b"Pf\n%d %d\n-1\n" % (width, height) + np.ones((height, width), "<f4").tobytes())
    with open(os.path.join(folder, "calib.txt"), "w") as file:
        file.write("ndisp=%d\n" % disparities)


def measure_speed(measured, options):
    """The methods in turns, one thread: CPU time is the wall time of an idle core then."""
    methods = ("bm", "sgbm_3way", "light", "fast")
    measured["speed"] = {"machine": machine(), "commit": commit(), "runs": options.runs,
                         "load": os.getloadavg()[0], "cores": os.cpu_count(), "cpu_ms": {}}
    for width, height, disparities in SIZES:
        with tempfile.TemporaryDirectory() as work:
            for run in range(options.runs + 1):  # the first warms up
                write_scene(os.path.join(work, "run%02d" % run), width, height, disparities)
            rows = evaluate(work, methods, False, "--threads", "1")
        measured["speed"]["cpu_ms"]["%d x %d x %d" % (width, height, disparities)] = {
            method: statistics.median(float(row["cpu_ms"]) for row in rows[method][1:]) for method in methods}
        write(measured)


FOCAL_PX, BASELINE_M, SIZE, RANGE_PX = 500.0, 0.1, (640, 480), 64
DISTANCES_M = (1.0, 2.0, 5.0, 10.0)
SLOPE = math.tan(math.radians(15.0))  # of the plane, about the vertical: its disparity takes all fractions of a pixel
NOISE = 2.0  # grey levels, of the sensor
FINER = 2  # samples per pixel and direction


def fractal(random, side):
    """A texture, side x side, with detail of every size; 8 bit grey levels."""
    texture = np.zeros((side, side))
    cells = 4
    while cells <= side:
        texture += cv2.resize(random.normal(size=(cells, cells)), (side, side), interpolation=cv2.INTER_CUBIC)
        cells *= 2
    return np.clip(128.0 + 15.0 * texture, 0, 255).astype(np.float32)


def plane_view(texture, distance, x_m):
    """What a camera x_m beside the left one sees of the plane Z = distance - SLOPE X, and its Z; both cameras look along Z."""
    columns, rows = ((np.arange(FINER * count) + 0.5) / FINER - 0.5 for count in SIZE)
    ray_x, ray_y = np.meshgrid((columns - SIZE[0] / 2.0) / FOCAL_PX, (rows - SIZE[1] / 2.0) / FOCAL_PX)
    z = (distance - SLOPE * x_m) / (1.0 + SLOPE * ray_x)
    per_m = FINER * FOCAL_PX / distance  # texture is as fine as the samples
    image = cv2.remap(texture, ((x_m + z * ray_x) * per_m).astype(np.float32), (z * ray_y * per_m).astype(np.float32),
                      cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP)
    return cv2.resize(image, SIZE, interpolation=cv2.INTER_AREA), cv2.resize(z, SIZE, interpolation=cv2.INTER_AREA)


def opencv_disparity(method, left, right):
    """OpenCV's matchers as `evaluate --peers` sets them; px, NaN = none."""
    if method == "bm":
        matcher = cv2.StereoBM_create(RANGE_PX, 15)
        matcher.setUniquenessRatio(15)
        matcher.setSpeckleWindowSize(100)
        matcher.setSpeckleRange(4)
        views = left, right
    else:
        matcher = cv2.StereoSGBM_create(0, RANGE_PX, 5, 600, 2400, 1, 63, 10, 100, 2, cv2.STEREO_SGBM_MODE_SGBM_3WAY)
        views = [cv2.cvtColor(view, cv2.COLOR_GRAY2BGR) for view in (left, right)]
    views = [cv2.copyMakeBorder(view, 0, 0, RANGE_PX, 0, cv2.BORDER_REPLICATE) for view in views]
    disparity = matcher.compute(*views)[:, RANGE_PX:] / 16.0
    return np.where(disparity > 0.0, disparity, np.nan)


def own_disparity(preset, left, right):
    with tempfile.TemporaryDirectory() as work:
        paths = [os.path.join(work, name) for name in ("left.png", "right.png", "out.pfm")]
        for path, view in zip(paths, (left, right)):
            cv2.imwrite(path, view)
        subprocess.run([MATCH, *paths[:2], "--output", paths[2], "--preset", preset, "--num-disparities", str(RANGE_PX)],
                       check=True, stdout=subprocess.DEVNULL)
        with open(paths[2], "rb") as file:
            file.readline(), file.readline(), file.readline()  # a little-endian PFM of SIZE, bottom row first
            disparity = np.flipud(np.frombuffer(file.read(), "<f4").reshape(SIZE[::-1]))
    return np.where(np.isfinite(disparity) & (disparity > 0.0), disparity, np.nan)


def measure_metres(measured, options):
    """Root mean square error of the depth of a tilted plane that both cameras see, with the noise of a sensor."""
    measured["metres"] = {"commit": commit(), "noise": NOISE, "rms_m": {}}
    for distance in DISTANCES_M:
        random = np.random.default_rng(1)
        texture = fractal(random, 2048)
        (left, z), (right, _) = (plane_view(texture, distance, x_m) for x_m in (0.0, BASELINE_M))
        left, right = (np.clip(np.rint(view + random.normal(0.0, NOISE, view.shape)), 0, 255).astype(np.uint8)
                       for view in (left, right))
        seen = np.arange(SIZE[0]) > RANGE_PX
        entry = {}
        for method in ("bm", "sgbm_3way", "light", "fast"):
            run = own_disparity if method in ("light", "fast") else opencv_disparity
            error = FOCAL_PX * BASELINE_M / run(method, left, right)[:, seen] - z[:, seen]
            entry[method] = float(np.sqrt(np.nanmean(error ** 2)))
            entry[method + "_answered"] = float(100.0 * np.isfinite(error).mean())
        measured["metres"]["rms_m"]["%g" % distance] = entry


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("accuracy", "speed", "metres"))
    parser.add_argument("--data", default=os.path.join(ROOT, "..", "shared", "data"), help="folder of the sets (default: %(default)s)")
    parser.add_argument("--sets", nargs="+", default=list(SETS))
    parser.add_argument("--methods", nargs="+", default=["fast", "light", *PEERS])
    parser.add_argument("--runs", type=int, default=7)
    options = parser.parse_args()
    measured = {}
    if os.path.exists(MEASURED):
        with open(MEASURED) as file:
            measured = json.load(file)
    {"accuracy": measure_accuracy, "speed": measure_speed, "metres": measure_metres}[options.what](measured, options)
    write(measured)


if __name__ == "__main__":
    main()
