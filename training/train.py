#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""Trains the network of matching_cost.type learned on synthetic pairs, through the scanline optimisation that follows it."""
import argparse
import collections
import math
import time

import cv2
import numpy as np
import torch
import torch.nn.functional as functional

import network
import pairs
import photos

DISPARITIES = 80
ROWS = 12  # of a crop; every second counts
CROPS = 6  # per step
LEAST = 1e4  # more than any cost

# The first steps of `schedule`: at first without the scanline optimisation. Shares of noisy, and of dark and of compressed
# pairs; the weight of pixels within 4 px of a depth edge, which a cost must not fatten. Bad images come first: with them to
# the end the network blurs the edges of good ones.
Phase = collections.namedtuple('Phase', 'steps schedule unsmoothed rate noisy spoilt edge_weight')
PHASES = Phase(1800, 3600, 540, 3e-3, 0.35, 0.15, 3.0), Phase(400, 400, 0, 1.5e-3, 0.08, 0.04, 5.0)


# Cameras: what happens to one view (H x W, 0..255) on its way into memory.
def gaussian(image, sigma):
    return cv2.GaussianBlur(image, (0, 0), sigma, borderType=cv2.BORDER_REPLICATE)


def lit(rng, image, strength):
    """Another exposure, light that differs over the image, vignetting."""
    height, width = image.shape
    image = (image / 255.0) ** math.exp(rng.normal(0, 0.25 * strength))
    image = image * math.exp(rng.normal(0, 0.2 * strength)) + rng.normal(0, 0.05 * strength)
    if rng.random() < 0.6:
        field = rng.normal(0, 0.15 * strength, (3, 7)).astype(np.float32)
        image = image * np.exp(cv2.resize(field, (width, height), interpolation=cv2.INTER_CUBIC))
    if rng.random() < 0.3:
        across = np.linspace(-1, 1, width) + rng.normal(0, 0.5)
        image = image * (1 - rng.uniform(0, 0.3) * across * across)
    return (image * 255.0).astype(np.float32)


def compressed(image, quality):
    _, data = cv2.imencode('.jpg', image, [cv2.IMWRITE_JPEG_QUALITY, quality])
    return cv2.imdecode(data, cv2.IMREAD_GRAYSCALE)


class Camera:
    """What both views of a pair have in common: sensor and compression."""

    def __init__(self, rng, phase):
        bad = rng.random() < phase.noisy
        self.noise = math.exp(rng.uniform(0.7, 2.0) if bad else rng.uniform(-1.6, 0.7))
        self.gain = rng.uniform(0.15, 0.6) if rng.random() < phase.spoilt else 1.0
        self.quality = int(rng.integers(20, 85)) if rng.random() < phase.spoilt else 0

    def take(self, rng, image):
        if rng.random() < 0.3:
            image = gaussian(image, rng.uniform(0.3, 0.8))
        elif rng.random() < 0.08:
            image = gaussian(image, rng.uniform(0.8, 1.7))
        image = lit(rng, image, 1.0 if rng.random() < 0.35 else 0.3) * self.gain
        noisy = image + rng.standard_normal(image.shape) * self.noise
        image = np.rint(np.clip(noisy, 0, 255)).astype(np.uint8)
        return compressed(image, self.quality) if self.quality else image


class Batch:
    """Crops of pairs as two cameras saw them."""

    def __init__(self, rng, phase, data, crops, rows):
        left, right, disparity, visible, weight = [], [], [], [], []
        for _ in range(crops):
            views, d, mask = self.pair_of(rng, phase, data)
            top = rng.integers(d.shape[0] - rows - 2 * network.REACH + 1)
            whole = slice(top, top + rows + 2 * network.REACH)
            seen = slice(top + network.REACH, top + network.REACH + rows)
            near_edge = cv2.dilate((mask != 255).astype(np.uint8), np.ones((9, 9), np.uint8)) > 0
            inner = slice(network.REACH, -network.REACH)
            left.append(views[0][whole])
            right.append(views[1][whole])
            disparity.append(d[seen, inner][::2])
            visible.append((mask[seen, inner] == 255)[::2])
            weight.append(np.where(near_edge, phase.edge_weight, 1.0)[seen, inner][::2])
        as_input = lambda crop: torch.from_numpy(np.stack(crop).astype(np.float32))[:, None]
        self.left, self.right = as_input(left), as_input(right)
        self.disparity = torch.from_numpy(np.concatenate(disparity).astype(np.float32))
        self.visible = torch.from_numpy(np.concatenate(visible))
        self.weight = torch.from_numpy(np.concatenate(weight).astype(np.float32))

    @staticmethod
    def pair_of(rng, phase, data):
        chosen = rng.integers(len(data[0]))
        left, right, disparity, mask = [values[chosen] for values in data]
        if rng.random() < 0.5:
            left, right, disparity, mask = [values[::-1] for values in (left, right, disparity, mask)]
        left, right = left.astype(np.float32), right.astype(np.float32)
        if rng.random() < 0.3:
            left, right = 255 - left, 255 - right
        camera = Camera(rng, phase)
        return [camera.take(rng, np.ascontiguousarray(view)) for view in (left, right)], disparity, mask


def messages(costs, p1, p2):
    """Minimal path costs from the left, as semi-global matching adds them up. costs (N, W, D), p2 (N, W)."""
    beyond = torch.full((costs.shape[0], 1), LEAST)
    path = costs[:, 0]
    paths = [path]
    for cost, jump in zip(costs.unbind(1)[1:], p2.unbind(1)[1:]):
        path = path - path.min(1, keepdim=True)[0]
        beside = torch.minimum(torch.cat([beyond, path[:, :-1]], 1), torch.cat([path[:, 1:], beyond], 1))
        path = cost + torch.minimum(torch.minimum(path, beside + p1), jump[:, None])
        paths.append(path)
    return torch.stack(paths, 1)


class Loss(torch.nn.Module):
    """Cross entropy of the true disparity, of the costs alone and after a scanline optimisation both ways."""

    def __init__(self):
        super().__init__()
        self.log_scale = torch.nn.Parameter(torch.tensor(2.3))
        self.log_p1 = torch.nn.Parameter(torch.tensor(1.0))
        self.log_p2 = torch.nn.Parameter(torch.tensor(2.7))
        self.log_sharpness = torch.nn.Parameter(torch.tensor(-0.7))

    def costs_of(self, left, right):
        """(N, W, D) from descriptors (B, C, H, W); the last valid cost is repeated."""
        left, right = left[:, :, ::2], right[:, :, ::2]
        batch, channels, height, width = left.shape
        a = left.permute(0, 2, 3, 1).reshape(batch * height, width, channels)
        b = right.permute(0, 2, 1, 3).reshape(batch * height, channels, width)
        similar = torch.bmm(a, b) * torch.exp(self.log_scale)
        at = (torch.arange(width)[:, None] - torch.arange(DISPARITIES)[None, :]).clamp(min=0)
        return -similar.gather(2, at[None].expand(batch * height, -1, -1))

    def optimised(self, costs, grey):
        step = (grey[:, 1:] - grey[:, :-1]).abs()
        p1 = torch.exp(self.log_p1)
        p2 = torch.maximum(torch.exp(self.log_p2) / (1 + 0.04 * step), p1)
        first = torch.zeros(costs.shape[0], 1)
        both = torch.cat([costs, costs.flip(1)])
        jumps = torch.cat([torch.cat([first, p2], 1), torch.cat([first, p2.flip(1)], 1)])
        there, back = messages(both, p1, jumps).chunk(2)
        return (there + back.flip(1) - costs) * torch.exp(self.log_sharpness)

    @staticmethod
    def cross_entropy(costs, batch):
        d = batch.disparity.clamp(0, DISPARITIES - 1.001)
        whole = d.floor().long()
        part = d - whole
        below, above = [costs.gather(2, (whole + i)[..., None])[..., 0] for i in (0, 1)]
        loss = torch.logsumexp(-costs, 2) + (1 - part) * below + part * above
        counted = Loss.counted(costs, batch)
        weight = batch.weight[counted]
        return (loss.clamp(max=12.0)[counted] * weight).sum() / weight.sum()

    @staticmethod
    def counted(costs, batch):
        inside = torch.arange(costs.shape[1])[None, :] >= batch.disparity
        return batch.visible & inside & (batch.disparity < DISPARITIES - 1)

    def forward(self, net, batch, smooth):
        """The loss and the share of pixels off by more than 1 px."""
        left, right = net(torch.cat([batch.left, batch.right])).chunk(2)
        costs = self.costs_of(left, right)
        loss = self.cross_entropy(costs, batch)
        if smooth:
            reach = network.REACH
            grey = batch.left[:, 0, reach:-reach, reach:-reach][:, ::2].reshape(costs.shape[:2])
            costs = self.optimised(costs, grey)
            loss = 0.15 * loss + self.cross_entropy(costs, batch)
        counted = self.counted(costs, batch)
        wrong = (costs.detach().argmin(2) - batch.disparity).abs() > 1
        return loss, wrong[counted].float().mean().item()


def learning_rate(phase, step):
    share = step / phase.schedule
    return phase.rate * min(1.0, share / 0.02 + 0.02) * (1 if share < 0.3 else 0.5 + 0.5 * math.cos(math.pi * (share - 0.3) / 0.7))


def validate(net, loss, batches):
    with torch.no_grad():
        results = [loss(net, batch, True) for batch in batches]
    return np.mean([float(value) for value, _ in results]), 100 * np.mean([wrong for _, wrong in results])


def train(net, phase, data, held_back, seed, report):
    rng = np.random.default_rng(seed)
    batches = [Batch(np.random.default_rng(99 + i), phase, held_back, 8, 24) for i in range(4)]
    loss = Loss()
    optimizer = torch.optim.Adam(list(net.parameters()) + list(loss.parameters()), betas=(0.9, 0.98))
    for step in range(phase.steps):
        if step % (phase.steps // 5) == 0:
            report(net, step, *validate(net, loss, batches))
        for group in optimizer.param_groups:
            group['lr'] = learning_rate(phase, step)
        value, _ = loss(net, Batch(rng, phase, data, CROPS, ROWS), step >= phase.unsmoothed)
        optimizer.zero_grad()
        value.backward()
        torch.nn.utils.clip_grad_norm_(net.parameters(), 2.0)
        optimizer.step()
    report(net, phase.steps, *validate(net, loss, batches))


def arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('photos', help='folder into which the packages of the photos were unpacked')
    parser.add_argument('weights', help='file to write')
    parser.add_argument('--shards', type=int, default=6, help='of 300 pairs')
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--threads', type=int, default=2)
    return parser.parse_args()


def main():
    options = arguments()
    torch.set_num_threads(options.threads)
    started = time.monotonic()

    def report(net, step, loss, wrong):
        network.write(net, options.weights)
        print('%5.0f s, step %5d: loss %.3f, %.2f %% off by more than 1 px' % (time.monotonic() - started, step, loss, wrong),
              flush=True)

    data = pairs.make_shards(options.photos, photos.TRAINING, options.shards, 300, 1001, options.threads)
    held_back = pairs.make_pairs(options.photos, photos.VALIDATION, 100, 1000)
    torch.manual_seed(options.seed)
    net = network.Network()
    for phase in PHASES:
        train(net, phase, data, held_back, options.seed, report)


if __name__ == '__main__':
    main()
