# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""The network of matching_cost.type learned, and the weights file that the library reads."""
import hashlib

import numpy as np
import torch
import torch.nn.functional as functional

CHANNELS = 24, 24, 32
SIDES = 5, 3, 3
REACH = 4  # px around a pixel that its descriptor sees
INPUT_SCALE = 32.0  # grey levels per 1
INPUT_BITS, WEIGHT_BITS, ACTIVATION_BITS = 17, 12, 10  # fixed point of the library
LARGEST_SUM = 2.0**31 / 2**ACTIVATION_BITS  # of the absolute weights of one output


def activation(x):
    x = x.clamp(-1.0, 1.0)
    return x * (3.0 - x * x) / 2.0


class Network(torch.nn.Module):
    """Grey values (B, 1, H, W), REACH px larger than the result on every side, to descriptors of length 1 at most."""

    def __init__(self):
        super().__init__()
        inputs = (1,) + CHANNELS[:-1]
        self.layers = torch.nn.ModuleList(
            torch.nn.Conv2d(i, o, side) for i, o, side in zip(inputs, CHANNELS, SIDES))
        for layer in self.layers:
            torch.nn.init.kaiming_normal_(layer.weight, nonlinearity='relu')
            torch.nn.init.zeros_(layer.bias)
        self.log_floor = torch.nn.Parameter(torch.tensor(-1.0))

    def forward(self, grey):
        first, second, third = self.layers
        weight = first.weight - first.weight.mean((2, 3), keepdim=True)  # blind to the mean grey
        x = activation(functional.conv2d(grey / INPUT_SCALE, weight, first.bias))
        x = third(activation(second(x)))
        return x * torch.rsqrt((x * x).sum(1, keepdim=True) + torch.exp(2 * self.log_floor))


def without_mean(weights):
    """Rounded weights of the first layer that add up to 0 exactly."""
    rounded = np.rint(weights)
    for i, filter_ in enumerate(rounded):
        error = weights[i] - filter_
        for _ in range(int(abs(filter_.sum()))):
            step = -np.sign(filter_.sum())
            place = np.unravel_index(np.argmax(error * step), error.shape)
            filter_[place] += step
            error[place] -= step
    return rounded


def integers(network):
    """Weights and biases as the library uses them."""
    result = []
    for index, layer in enumerate(network.layers):
        weight, bias = layer.weight.detach().double().numpy(), layer.bias.detach().double().numpy()
        if index == 0:
            weight = weight - weight.mean((2, 3), keepdims=True)
            weight = without_mean(weight / INPUT_SCALE * 2**INPUT_BITS)
            bias = np.rint(bias * 2**INPUT_BITS)
        else:
            weight = np.rint(weight * 2**WEIGHT_BITS)
            bias = np.rint(bias * 2**(WEIGHT_BITS + ACTIVATION_BITS))
        result.append((weight.astype(int), bias.astype(int)))
    return result


def write(network, path):
    """One line per filter: weights by row, column, input channel, then the bias. Ends with the SHA-256 of what is above."""
    lines = ['fdp_stereo_cost_network 1', 'channels ' + ' '.join(map(str, CHANNELS)),
             'floor %d' % round(float(torch.exp(network.log_floor)) * 65536)]
    for weights, biases in integers(network):
        for weight, bias in zip(weights, biases):
            numbers = weight.transpose(1, 2, 0).ravel()
            lines.append(' '.join(map(str, numbers)) + ' ' + str(bias))
    text = '\n'.join(lines) + '\n'
    with open(path, 'w') as file:
        file.write(text + 'sha256 %s\n' % hashlib.sha256(text.encode()).hexdigest())
