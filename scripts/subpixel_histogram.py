#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""Fractional parts of the disparities by sub-pixel fit: subpixel_histogram.py MATCH PICTURE SCENE...

MATCH is the program, PICTURE the .png to write, SCENE a folder with im0.png, im1.png, disp0GT.pfm, calib.txt. Where a fit
locks to integers the histogram has a peak in the middle, where it avoids them a valley; the truth has neither. Only pixels
within half a pixel of the truth count, so that the comparison is of the fit alone.
"""
import os
import re
import subprocess
import sys
import tempfile

import cv2
import numpy as np

PLAIN = ["weighted_median.radius=0", "disparity_smoothing.radius=0"]
FITS = {
    "parabola": ["semi_global.subpixel=parabola", *PLAIN],
    "equiangular": ["semi_global.subpixel=equiangular", *PLAIN],
    "blended": ["semi_global.subpixel=blended", *PLAIN],
    "blended, median, smoothing": ["semi_global.subpixel=blended"],
}
BINS = 40
WIDTH, HEIGHT, MARGIN = 400, 260, 30


def read_pfm(path):
    with open(path, "rb") as file:
        file.readline()
        width, height = map(int, file.readline().split())
        order = "<" if float(file.readline()) < 0 else ">"
        disparity = np.frombuffer(file.read(), order + "f4").reshape(height, width)[::-1].astype(np.float32)
    disparity[~np.isfinite(disparity)] = np.nan
    return disparity


def num_disparities(scene):
    with open(os.path.join(scene, "calib.txt"), encoding="ascii") as file:
        return re.search(r"ndisp\s*=\s*(\d+)", file.read()).group(1)


def match(program, scene, settings, folder):
    out = os.path.join(folder, "disparity.pfm")
    command = [program, os.path.join(scene, "im0.png"), os.path.join(scene, "im1.png"), "-o", out, "--overwrite",
               "--num-disparities", num_disparities(scene)]
    for setting in settings:
        command += ["--set", setting]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return read_pfm(out)


def fractions(disparity):
    return disparity - np.rint(disparity)


def histogram(values):
    counts, _ = np.histogram(values, bins=BINS, range=(-0.5, 0.5))
    return counts / max(1, counts.sum()) * BINS  # 1 = even


def collect(program, scenes):
    """name -> (fractional parts, errors, errors above 1/8 px in %)."""
    found = {name: ([], []) for name in ["truth", *FITS]}
    with tempfile.TemporaryDirectory() as folder:
        for scene in scenes:
            truth = read_pfm(os.path.join(scene, "disp0GT.pfm"))
            for name, settings in FITS.items():
                disparity = match(program, scene, settings, folder)
                near = np.abs(disparity - truth) < 0.5
                found[name][0].append(fractions(disparity[near]))
                found[name][1].append((disparity - truth)[near])
            found["truth"][0].append(fractions(truth[np.isfinite(truth)]))
            found["truth"][1].append(np.zeros(1))
    return {name: (np.concatenate(parts), np.concatenate(errors)) for name, (parts, errors) in found.items()}


def panel(name, values):
    image = np.full((HEIGHT, WIDTH, 3), 255, np.uint8)
    scale = (HEIGHT - 2 * MARGIN) / 2.5
    bar = (WIDTH - 2 * MARGIN) / BINS
    for i, value in enumerate(histogram(values)):
        left, right = int(MARGIN + i * bar), int(MARGIN + (i + 1) * bar) - 1
        top = int(HEIGHT - MARGIN - min(value, 2.5) * scale)
        cv2.rectangle(image, (left, top), (right, HEIGHT - MARGIN), (180, 120, 60), cv2.FILLED)
    even = int(HEIGHT - MARGIN - scale)
    cv2.line(image, (MARGIN, even), (WIDTH - MARGIN, even), (60, 60, 200), 1)
    font = cv2.FONT_HERSHEY_SIMPLEX
    cv2.putText(image, name, (MARGIN, 20), font, 0.5, (0, 0, 0), 1, cv2.LINE_AA)
    for text, x in (("-0.5", MARGIN - 14), ("0", WIDTH // 2 - 4), ("0.5 px", WIDTH - MARGIN - 26)):
        cv2.putText(image, text, (x, HEIGHT - 10), font, 0.4, (0, 0, 0), 1, cv2.LINE_AA)
    return image


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    program, picture, scenes = sys.argv[1], sys.argv[2], sys.argv[3:]
    found = collect(program, scenes)
    print("| fit | unevenness | within 0.05 px of an integer, % | > 1/8 px off, % |\n|---|---|---|---|")
    for name, (parts, errors) in found.items():
        uneven = np.sqrt(np.mean((histogram(parts) - 1.0) ** 2))
        locked = 100.0 * np.mean(np.abs(parts) < 0.05)
        off = 100.0 * np.mean(np.abs(errors) > 0.125)
        print(f"| {name} | {uneven:.3f} | {locked:.1f} | {'' if name == 'truth' else f'{off:.1f}'} |")
    panels = [panel(name, parts) for name, (parts, _) in found.items()]
    cv2.imwrite(picture, np.hstack(panels))


if __name__ == "__main__":
    main()
