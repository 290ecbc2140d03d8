#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""Fits the model of confidence and sigma: fit_confidence.py MATCH OUT.hpp SET... [-- arguments of match]

SET is a folder of scenes: im0.png, im1.png, disp0GT.pfm (or disp0GT.png with disp0GT.scale.txt), mask0nocc.png where
known (255 = seen by both cameras), calib.txt where known (ndisp=). Every scene is matched as it is, with noise, and
darkened with noise. The model is a logistic regression on hinges; its second output is the logarithm of sigma, the 68 %
quantile of the error. Before the model is fitted to all, it is fitted once without each quarter of the scenes, and once
without each set, and the kept-back ones are scored. Needs Debian's python3-numpy and python3-opencv.
"""
import argparse
import os
import re
import subprocess
import sys
import tempfile

import cv2
import numpy as np

UNITS = 12
PIXELS = 15000  # per scene
KINDS = {"clean": 2.0, "noise": 0.5, "dark": 0.5}  # weights
QUANTILE = 0.69
SMALLEST_ERROR = 0.02  # px


def read_pfm(path):
    with open(path, "rb") as file:
        file.readline()
        width, height = map(int, file.readline().split())
        kind = "<f4" if float(file.readline()) < 0 else ">f4"
        return np.flipud(np.frombuffer(file.read(), kind).reshape(height, width)).astype(np.float32)


def truth(scene):
    pfm = os.path.join(scene, "disp0GT.pfm")
    if os.path.exists(pfm):
        disparity = read_pfm(pfm)
    else:
        with open(os.path.join(scene, "disp0GT.scale.txt")) as file:
            scale = float(re.search(r"[\d.]+", file.read()).group())
        disparity = cv2.imread(os.path.join(scene, "disp0GT.png"), cv2.IMREAD_ANYDEPTH).astype(np.float32) / scale
    scored = np.isfinite(disparity) & (disparity > 0)
    disparity = np.where(scored, disparity, 0.0)
    mask = os.path.join(scene, "mask0nocc.png")
    if not os.path.exists(mask):
        return disparity, scored
    return disparity, scored & (cv2.imread(mask, cv2.IMREAD_GRAYSCALE) == 255)


def disparities(scene, disparity, scored):
    calibration = os.path.join(scene, "calib.txt")
    if os.path.exists(calibration):
        with open(calibration) as file:
            found = re.search(r"ndisp\s*=\s*(\d+)", file.read())
        if found:
            return int(found.group(1))
    return int(np.ceil(disparity[scored].max())) + 4


def spoil(image, kind, random):
    values = image.astype(np.float32)
    if kind == "noise":
        values += random.normal(0, 6, values.shape)
    if kind == "dark":
        values = values * 0.25 + random.normal(0, 2, values.shape)
    return np.clip(np.round(values), 0, 255).astype(np.uint8)


def match_scene(match, scene, kind, extra, folder):
    """Measures and errors of the answered pixels whose truth is known."""
    disparity, scored = truth(scene)
    random = np.random.default_rng(1)
    names = [os.path.join(folder, name) for name in ("left.png", "right.png", "disparity.pfm", "measures.npy")]
    for i in (0, 1):
        image = cv2.imread(os.path.join(scene, f"im{i}.png"), cv2.IMREAD_UNCHANGED)
        cv2.imwrite(names[i], spoil(image, kind, random))
    subprocess.run([match, names[0], names[1], "--output", names[2], "--measures", names[3], "--overwrite",
                    "--num-disparities", str(disparities(scene, disparity, scored))] + extra,
                   check=True, stdout=subprocess.DEVNULL)
    found, measures = read_pfm(names[2]), np.load(names[3])
    use = np.flatnonzero(scored & np.isfinite(found))
    use = random.permutation(use)[:PIXELS]
    return measures.reshape(measures.shape[0], -1)[:, use].T, np.abs(found.ravel()[use] - disparity.ravel()[use])


def nearly_exp(x, limit):
    """As the program computes it."""
    return (1.0 + np.clip(x, -limit, limit) / 256.0) ** 256


def forward(model, measures):
    hidden = np.maximum(measures @ model["weights"] + model["bias"], 0.0)
    return hidden, hidden @ model["out"] + model["out_bias"]


def gradients(model, measures, error, weight):
    """Of the logistic loss, and of the quantile loss of the logarithm of the error."""
    hidden, out = forward(model, measures)
    probability = 1.0 / (1.0 + nearly_exp(-out[:, 0], 12.0))
    logarithm = np.log(np.maximum(error, SMALLEST_ERROR))
    slope = np.stack([probability - (error <= 1.0),
                      0.3 * probability * np.where(logarithm > out[:, 1], -QUANTILE, 1.0 - QUANTILE)], 1)
    slope *= weight[:, None] / len(weight)
    back = (slope @ model["out"].T) * (hidden > 0)
    return {"weights": measures.T @ back, "bias": back.sum(0), "out": hidden.T @ slope, "out_bias": slope.sum(0)}


def fit(samples, epochs=12, batch=1024, largest_step=0.015):
    """Adam with steps that grow and then fall; every set counts the same, KITTI's noisy streets more."""
    measures = np.concatenate([s["measures"] for s in samples]).astype(np.float64)
    error = np.concatenate([s["error"] for s in samples])
    pixels = {}
    for s in samples:
        pixels[s["set"], s["kind"]] = pixels.get((s["set"], s["kind"]), 0) + len(s["error"])
    weight = np.concatenate([np.full(len(s["error"]), s["weight"] / pixels[s["set"], s["kind"]]) for s in samples])
    weight /= weight.mean()
    mean, spread = measures.mean(0), measures.std(0) + 1e-6
    measures = (measures - mean) / spread
    random = np.random.default_rng(0)
    model = {"weights": random.normal(0, (2.0 / measures.shape[1]) ** 0.5, (measures.shape[1], UNITS)),
             "bias": np.zeros(UNITS), "out": random.normal(0, 0.1, (UNITS, 2)), "out_bias": np.array([2.0, -1.0])}
    first = {k: np.zeros_like(v) for k, v in model.items()}
    second = {k: np.zeros_like(v) for k, v in model.items()}
    steps = epochs * (len(error) // batch)
    for step in range(steps):
        if step % (len(error) // batch) == 0:
            order = random.permutation(len(error))
        part = order[step % (len(error) // batch) * batch:][:batch]
        done = step / steps
        rate = largest_step * min(done / 0.2 + 0.05, 1.0) * (1.0 if done < 0.2 else 0.5 + 0.5 * np.cos(np.pi * (done - 0.2) / 0.8))
        for k, g in gradients(model, measures[part], error[part], weight[part]).items():
            first[k] = 0.9 * first[k] + 0.1 * g
            second[k] = 0.999 * second[k] + 0.001 * g * g
            size = np.sqrt(second[k] / (1 - 0.999 ** (step + 1))) + 1e-8
            model[k] -= rate * first[k] / (1 - 0.9 ** (step + 1)) / size
    model["bias"] = model["bias"] - (mean / spread) @ model["weights"]
    model["weights"] = model["weights"] / spread[:, None]
    return model


def score(model, sample):
    out = forward(model, sample["measures"])[1]
    confidence, sigma = 1.0 / (1.0 + nearly_exp(-out[:, 0], 12.0)), nearly_exp(out[:, 1], 3.5)
    error = sample["error"]
    wrong = error > 1.0
    order = np.argsort(-confidence, kind="stable")
    rank = np.empty(len(error))
    rank[order[::-1]] = np.arange(1, len(error) + 1)
    bad, good = wrong.sum(), (~wrong).sum()
    auc = 1.0 - (rank[wrong].sum() - bad * (bad + 1) / 2) / max(bad * good, 1)
    calibration = np.mean([abs(confidence[i].mean() - 1.0 + wrong[i].mean()) for i in np.array_split(order, 10)])
    sure = confidence > 0.8
    return [auc, 100 * wrong[order[:int(0.8 * len(order))]].mean(), calibration,
            100 * (error < sigma)[sure].mean(), 100 * (error < 3 * sigma)[sure].mean()]


def report(name, rows):
    for (folder, kind) in sorted({r[:2] for r in rows}):
        m = np.nanmean([r[2] for r in rows if r[:2] == (folder, kind)], 0)
        print(f"{name:22s} {folder:22s} {kind:6s} AUC {m[0]:.3f}, wrong in the most confident 80 % {m[1]:.2f} %, calibration "
              f"error {m[2]:.3f}, below 1 and 3 sigma {m[3]:.1f} {m[4]:.1f} %", flush=True)


def cross_validate(samples):
    scenes = sorted({(s["set"], s["scene"]) for s in samples})
    rows = []
    for quarter in range(4):
        kept = set(scenes[quarter::4])
        model = fit([s for s in samples if (s["set"], s["scene"]) not in kept], 5)
        rows += [(s["set"], s["kind"], score(model, s)) for s in samples if (s["set"], s["scene"]) in kept]
    report("kept-back scenes", rows)
    for folder in sorted({s["set"] for s in samples}):
        model = fit([s for s in samples if s["set"] != folder], 5)
        report("kept-back set", [(s["set"], s["kind"], score(model, s)) for s in samples if s["set"] == folder])


def write_header(path, model):
    number = lambda v: f"{v:.4f}F"
    lines = ["// SPDX-FileCopyrightText: 2026 The fdp_stereo authors", "// SPDX-License-Identifier: BSD-3-Clause", "//",
             "// Written by benchmark/fit_confidence.py (docs/confidence.md).", "#pragma once", "",
             '#include "simd/confidence_kernels.hpp"', "", "namespace fdp_stereo {", "", "// clang-format off",
             "/// bias; weights of margin, left-right distance, roughness near and wide, margin around, texture, contrast,",
             "/// distance to the border, disparity, spread and offset near and wide, share known; shares in logit and log sigma",
             "constexpr ConfidenceModel kConfidenceModel = {{"]
    for j in range(UNITS):
        weights = ", ".join(number(w) for w in model["weights"][:, j])
        lines.append(f"    {{{number(model['bias'][j])}, {{{weights}}}, {number(model['out'][j, 0])}, {number(model['out'][j, 1])}}},")
    lines += [f"}}, {number(model['out_bias'][0])}, {number(model['out_bias'][1])}}};", "// clang-format on", "",
              "}  // namespace fdp_stereo", ""]
    with open(path, "w") as file:
        file.write("\n".join(lines))


def load(arguments):
    samples = []
    with tempfile.TemporaryDirectory() as folder:
        for path in arguments.sets:
            for scene in sorted(os.listdir(path)):
                for kind, weight in KINDS.items():
                    if not os.path.exists(os.path.join(path, scene, "im0.png")):
                        continue
                    measures, error = match_scene(arguments.match, os.path.join(path, scene), kind, arguments.extra, folder)
                    name = os.path.basename(path.rstrip("/"))
                    weight_of_set = dict(w.split("=") for w in arguments.weight).get(name, 1.0)
                    samples.append({"set": name, "scene": scene, "kind": kind, "measures": measures, "error": error,
                                    "weight": weight * float(weight_of_set)})
    return samples


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("match")
    parser.add_argument("header")
    parser.add_argument("sets", nargs="+")
    parser.add_argument("--weight", action="append", default=[], metavar="SET=W", help="how much a set counts, beside 1")
    parser.add_argument("--no-validation", action="store_true")
    words = sys.argv[1:]
    extra = words[words.index("--") + 1:] if "--" in words else []
    arguments = parser.parse_args(words[:words.index("--")] if "--" in words else words)
    arguments.extra = extra
    samples = load(arguments)
    if not arguments.no_validation:
        cross_validate(samples)
    model = fit(samples)
    report("all, as written", [(s["set"], s["kind"], score(model, s)) for s in samples])
    write_header(arguments.header, model)


if __name__ == "__main__":
    main()
