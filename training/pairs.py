# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""Synthetic pairs with known disparity: slanted and curved layers with photos or patterns on them, drawn at twice the size."""
import multiprocessing

import cv2
import numpy as np

import photos

HEIGHT, WIDTH, LARGEST = 64, 256, 72  # px, of a pair and of its disparity
BORDER = 256  # px by which masks go beyond the left view, for the right one
SIDE = 700  # px of a pattern


def noise_pattern(rng):
    pattern = np.zeros((SIDE, SIDE), np.float32)
    falloff = rng.uniform(0.4, 1.1)
    for octave in range(2, 9):
        cells = rng.standard_normal((2**octave, 2**octave)).astype(np.float32)
        pattern += cv2.resize(cells, (SIDE, SIDE), interpolation=cv2.INTER_CUBIC) * falloff**octave
    return pattern / pattern.std() * rng.uniform(8, 50) + rng.uniform(60, 190)


def drawn_pattern(rng):
    pattern = np.full((SIDE, SIDE), rng.uniform(30, 220), np.float32)
    for _ in range(rng.integers(20, 140)):
        corners = rng.uniform(0, SIDE, 2) + rng.uniform(5, 120) * rng.uniform(-1, 1, (rng.integers(3, 6), 2))
        grey = float(rng.uniform(0, 255))
        if rng.random() < 0.5:
            cv2.fillPoly(pattern, [corners.astype(np.int32)], grey, cv2.LINE_AA)
        else:
            cv2.polylines(pattern, [corners.astype(np.int32)], False, grey, int(rng.integers(1, 6)), cv2.LINE_AA)
    return pattern


def grain(rng, sigma):
    return cv2.GaussianBlur(rng.standard_normal((SIDE, SIDE)).astype(np.float32), (0, 0), sigma) * sigma * 3.5


def striped_pattern(rng):
    y, x = np.mgrid[0:SIDE, 0:SIDE].astype(np.float32)
    angle, period = rng.uniform(0, np.pi), rng.uniform(4, 60)
    along = np.cos(angle) * x + np.sin(angle) * y
    across = np.cos(angle) * y - np.sin(angle) * x
    pattern = 127 + rng.uniform(10, 90) * np.sign(np.sin(along * 2 * np.pi / period))
    if rng.random() < 0.6:
        pattern += rng.uniform(5, 50) * np.sign(np.sin(across * 2 * np.pi / (period * rng.uniform(0.5, 3))))
    return pattern + grain(rng, rng.uniform(1, 6)) * rng.uniform(0.3, 4)


def plain_pattern(rng):
    y, x = np.mgrid[0:SIDE, 0:SIDE].astype(np.float32)
    pattern = rng.uniform(60, 200) + rng.uniform(-0.15, 0.15) * x + rng.uniform(-0.15, 0.15) * y
    for sigma in (1.0, 2.5, 7.0):
        pattern = pattern + grain(rng, sigma) * rng.uniform(0, 3)
    return pattern


PATTERNS = (noise_pattern, drawn_pattern, striped_pattern, plain_pattern)


def pattern_of(rng):
    pattern = PATTERNS[rng.integers(len(PATTERNS))](rng)
    if rng.random() < 0.6:
        pattern = cv2.GaussianBlur(pattern, (0, 0), rng.uniform(0.5, 1.5))
    return np.clip(pattern, 0, 255).astype(np.float32)


class Layer:
    """A surface in the left view (of twice the size): texture, disparity and mask."""

    def __init__(self, rng, pyramids, nearness, slopes, background):
        self.offset = nearness
        self.slope = np.clip(rng.normal(0, slopes), -0.35, 0.35)
        self.centre = rng.uniform(0, 2 * WIDTH + 2 * LARGEST), rng.uniform(0, 2 * HEIGHT)
        bumps = rng.standard_normal((5, 9)).astype(np.float32) * rng.choice([0.0, 0.0, 3.0])
        self.bump = cv2.resize(bumps, (2 * WIDTH + BORDER, 2 * HEIGHT), interpolation=cv2.INTER_CUBIC)
        self.mask = self.shape_of(rng, background)
        self.choose_texture(rng, pyramids)

    @staticmethod
    def shape_of(rng, background):
        size = 2 * HEIGHT, 2 * WIDTH + BORDER
        if background:
            return np.full(size, 255, np.uint8)
        mask = np.zeros(size, np.uint8)
        centre = np.array([rng.uniform(0, 2 * WIDTH + 100), rng.uniform(0, 2 * HEIGHT)])
        kind = rng.integers(4)
        if kind == 0:
            corners = centre + rng.uniform(15, 110) * rng.uniform(-1, 1, (rng.integers(3, 8), 2))
            cv2.fillPoly(mask, [cv2.convexHull(corners.astype(np.int32))], 255)
        elif kind == 1:
            axes = int(rng.uniform(8, 110)), int(rng.uniform(8, 80))
            cv2.ellipse(mask, tuple(map(int, centre)), axes, float(rng.uniform(0, 180)), 0, 360, 255, -1)
        elif kind == 2:
            end = centre + rng.uniform(-300, 300, 2)
            cv2.line(mask, tuple(map(int, centre)), tuple(map(int, end)), 255, int(rng.integers(3, 26)))
        else:
            corners = centre + rng.uniform(20, 160) * rng.uniform(-1, 1, (rng.integers(4, 10), 2))
            cv2.fillPoly(mask, [corners.astype(np.int32)], 255)
        return mask

    def choose_texture(self, rng, pyramids):
        if rng.random() < 0.25:
            self.texture = pattern_of(rng)
        else:
            levels = pyramids[rng.integers(len(pyramids))]
            self.texture = levels[rng.integers(len(levels))]
        angle = rng.normal(0, 0.25) if rng.random() < 0.8 else rng.uniform(0, 2 * np.pi)
        scale = rng.uniform(0.75, 1.25)
        cos, sin = np.cos(angle) * scale, np.sin(angle) * scale
        self.turn = np.array([[cos, -sin], [sin, cos]]) * [[rng.choice([-1, 1])], [1]]
        extent = np.array(self.texture.shape[::-1])
        tries = 5 if rng.random() < 0.4 else 1  # the flattest of them: weak texture
        places = [rng.uniform(0, 1, 2) * extent for _ in range(tries)]
        y, x = np.mgrid[0 : 2 * HEIGHT : 8, 0 : 2 * WIDTH : 8].astype(np.float32)
        crops = [self.lookup(x, y, place) for place in places]
        flattest = int(np.argmin([crop.std() for crop in crops]))
        self.place, self.mean = places[flattest], crops[flattest].mean()
        self.contrast = 1.0 if rng.random() < 0.55 else rng.uniform(0.08, 1.0)
        self.lift = rng.normal(0, 12) if rng.random() < 0.5 else 0.0

    def lookup(self, x, y, place):
        u = (self.turn[0, 0] * x + self.turn[0, 1] * y + place[0]).astype(np.float32)
        v = (self.turn[1, 0] * x + self.turn[1, 1] * y + place[1]).astype(np.float32)
        return cv2.remap(self.texture, u, v, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REFLECT)

    def grey(self, x, y):
        return (self.lookup(x, y, self.place) - self.mean) * self.contrast + self.mean + self.lift

    def disparity(self, x, y):
        bump = 0.0
        if self.bump.any():
            bump = cv2.remap(self.bump, x.astype(np.float32), y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        plane = 2 * self.offset + self.slope[0] * (x - self.centre[0]) + self.slope[1] * (y - self.centre[1])
        return np.clip(plane + bump, 0, 2 * LARGEST).astype(np.float32)


def row_offsets(rng, x, y):
    """What rectification and row alignment leave: a shift and a tilt."""
    if rng.random() < 0.35:
        return np.zeros_like(x)
    shift = np.clip(rng.normal(0, 0.25), -0.6, 0.6)
    tilt, stretch = rng.normal(0, 0.15), rng.normal(0, 0.1)
    return (2 * (shift + tilt * (x / x.shape[1] - 0.5) + stretch * (y / y.shape[0] - 0.5))).astype(np.float32)


def layers_of(rng, pyramids):
    farthest = rng.uniform(0, LARGEST * 0.6)
    slopes = rng.choice([0.03, 0.08, 0.2]), rng.choice([0.03, 0.1, 0.25])
    nearer = [farthest + rng.uniform(0.5, 1) ** 2 * rng.uniform(1, LARGEST - farthest) for _ in range(rng.integers(2, 9))]
    layers = [Layer(rng, pyramids, farthest, slopes, True)]
    return layers + [Layer(rng, pyramids, d, slopes, False) for d in sorted(nearer)]


class View:
    def __init__(self, shape):
        self.grey, self.disparity = np.zeros(shape, np.float32), np.zeros(shape, np.float32)
        self.layer = np.zeros(shape, np.float32)

    def draw(self, index, inside, grey, disparity):
        self.grey[inside], self.disparity[inside], self.layer[inside] = grey[inside], disparity[inside], index


def seen_twice(left, right, x, y):
    """Left pixels whose match shows the same surface."""
    at = x - left.disparity
    layer = cv2.remap(right.layer, np.clip(at, 0, at.shape[1] - 1), y, cv2.INTER_NEAREST)
    disparity = cv2.remap(right.disparity, np.clip(at, 0, at.shape[1] - 1), y, cv2.INTER_NEAREST)
    return (at >= 0) & (layer == left.layer) & (np.abs(disparity - left.disparity) < 1.5)


def all_four(flags):
    return flags.reshape(HEIGHT, 2, WIDTH, 2).all(axis=(1, 3))


def make_pair(rng, pyramids):
    """Left and right grey (float), disparity, and a mask: 255 seen by both, 128 by the left view alone, 0 at an edge."""
    y, x = np.mgrid[0 : 2 * HEIGHT, 0 : 2 * WIDTH].astype(np.float32)
    rows = y + row_offsets(rng, x, y)
    left, right = View(x.shape), View(x.shape)
    for index, layer in enumerate(layers_of(rng, pyramids)):
        left.draw(index, layer.mask[:, : 2 * WIDTH] > 0, layer.grey(x, y), layer.disparity(x, y))
        source = x + layer.disparity(x, rows)
        for _ in range(6):  # the left x whose match is here
            source = x + layer.disparity(source, rows)
        source = source.astype(np.float32)
        inside = cv2.remap(layer.mask, source, rows, cv2.INTER_NEAREST, borderMode=cv2.BORDER_REPLICATE) > 0
        right.draw(index, inside, layer.grey(source, rows), source - x)
    visible = all_four(seen_twice(left, right, x, y))
    corner = np.repeat(np.repeat(left.layer[::2, ::2], 2, 0), 2, 1)
    whole = all_four(left.layer == corner)
    reduce = lambda image: cv2.resize(image, (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA)
    mask = np.where(whole & visible, 255, np.where(whole, 128, 0)).astype(np.uint8)
    greys = [np.clip(reduce(view.grey), 0, 255) for view in (left, right)]
    return greys[0], greys[1], reduce(left.disparity) / 2, mask


def make_pairs(folder, files, count, seed):
    """`count` pairs as four arrays: left, right, disparity, mask."""
    cv2.setNumThreads(1)
    rng = np.random.default_rng(seed)
    pyramids = photos.load(folder, files)
    pairs = [make_pair(rng, pyramids) for _ in range(count)]
    types = np.float16, np.float16, np.float32, np.uint8
    return [np.stack([pair[i] for pair in pairs]).astype(types[i]) for i in range(4)]


def make_shards(folder, files, shards, count, seed, processes):
    """`count` pairs of each of the seeds `seed`, `seed` + 1, ... together, made by several processes."""
    jobs = [(folder, files, count, seed + i) for i in range(shards)]
    with multiprocessing.get_context('spawn').Pool(processes) as pool:
        made = pool.starmap(make_pairs, jobs)
    return [np.concatenate([shard[i] for shard in made]) for i in range(4)]
