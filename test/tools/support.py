# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the command-line tools share: running a tool, a rendered pair, PFM files."""
import os
import subprocess

import cv2
import numpy as np

BIN = os.environ["FDP_STEREO_BIN"]
SHIFTS = (4, 9)  # px: background and foreground of the rendered pair


def run(tool, *arguments, timeout=600):
    """Runs a tool and returns (exit code, stdout, stderr)."""
    done = subprocess.run([os.path.join(BIN, tool), *map(str, arguments)], stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=timeout)
    return done.returncode, done.stdout, done.stderr


def rendered_pair(height=60, width=110, seed=1):
    """A textured square before a textured wall: left, right, disparity of the left view."""
    random = np.random.RandomState(seed)
    texture = cv2.GaussianBlur(random.randint(0, 256, (height, width + 40, 3)).astype(np.uint8), (3, 3), 0)
    front = cv2.GaussianBlur(random.randint(0, 256, (height, width + 40, 3)).astype(np.uint8), (3, 3), 0)
    truth = np.full((height, width), float(SHIFTS[0]), np.float32)
    truth[15:45, 40:80] = SHIFTS[1]
    left, right = texture[:, 20:20 + width].copy(), texture[:, 20 + SHIFTS[0]:20 + SHIFTS[0] + width].copy()
    left[15:45, 40:80] = front[15:45, 40:80]
    right[15:45, 40 - SHIFTS[1]:80 - SHIFTS[1]] = front[15:45, 40:80]
    return left, right, truth


def read_pfm(path):
    with open(path, "rb") as file:
        assert file.readline().strip() == b"Pf"
        width, height = map(int, file.readline().split())
        order = "<f4" if float(file.readline()) < 0 else ">f4"
        return np.flipud(np.frombuffer(file.read(), order).reshape(height, width)).astype(np.float32)


def write_pfm(path, disparity):
    with open(path, "wb") as file:
        file.write(b"Pf\n%d %d\n-1\n" % (disparity.shape[1], disparity.shape[0]))
        file.write(np.flipud(disparity).astype("<f4").tobytes())


def write_scene(folder, seed=1, num_disparities=16):
    """A Middlebury folder with the rendered pair; what the right view does not see is masked out."""
    os.makedirs(folder)
    left, right, truth = rendered_pair(seed=seed)
    cv2.imwrite(os.path.join(folder, "im0.png"), left)
    cv2.imwrite(os.path.join(folder, "im1.png"), right)
    mask = np.full(truth.shape, 255, np.uint8)
    mask[:, :SHIFTS[0]] = 128
    mask[15:45, 40 - (SHIFTS[1] - SHIFTS[0]):40] = 128
    cv2.imwrite(os.path.join(folder, "mask0nocc.png"), mask)
    truth[0, 50] = np.inf
    write_pfm(os.path.join(folder, "disp0GT.pfm"), truth)
    with open(os.path.join(folder, "calib.txt"), "w") as file:
        file.write("ndisp=%d\n" % num_disparities)
    return truth, mask
