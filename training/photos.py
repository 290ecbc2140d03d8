# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""The photos that training pairs are made from: files of Debian packages under licences that ask for no more than a name."""
import os
import pickle

import cv2
import numpy as np

LOMIRI = 'usr/share/backgrounds/'
SKIMAGE = 'usr/lib/python3/dist-packages/skimage/data/'
SKLEARN = 'usr/lib/python3/dist-packages/sklearn/datasets/images/'
SCIPY = 'usr/lib/python3/dist-packages/scipy/misc/'

# File, licence, author. skimage's stereo pair is a scene of the evaluation and is not used.
TRAINING = [
    (LOMIRI + 'aitzgorri_by_Aitzol_Berasategi.jpg', 'CC-BY-4.0', 'Aitzol Berasategi'),
    (LOMIRI + 'friends_by_Aitzol_Berasategi.jpg', 'CC-BY-4.0', 'Aitzol Berasategi'),
    (LOMIRI + 'life_by_Aitzol_Berasategi.jpg', 'CC-BY-4.0', 'Aitzol Berasategi'),
    (LOMIRI + 'picosdeeuropa_by_Aitzol_Berasategi.jpg', 'CC-BY-4.0', 'Aitzol Berasategi'),
    (LOMIRI + 'sunset_by_Aitzol_Berasategi.jpg', 'CC-BY-4.0', 'Aitzol Berasategi'),
    (LOMIRI + 'Picture_0B_by_freespace.jpg', 'CC-BY-4.0', 'Trevor "Freespace"'),
    (LOMIRI + 'Wine_by_Jakkub_Mede.jpg', 'CC-BY-4.0', 'Jakub Mede'),
    (LOMIRI + 'seeding_by_Clements_Engelhardt.jpg', 'CC0-1.0', 'Clemens Engelhardt'),
    (SKLEARN + 'china.jpg', 'CC-BY-2.0', 'danielbuechele'),
    (SKIMAGE + 'astronaut.png', 'public domain', 'NASA'),
    (SKIMAGE + 'rocket.jpg', 'public domain', 'SpaceX'),
    (SKIMAGE + 'camera.png', 'CC0-1.0', 'Lav Varshney'),
    (SKIMAGE + 'chelsea.png', 'CC0-1.0', 'Stefan van der Walt'),
    (SKIMAGE + 'brick.png', 'CC0-1.0', 'CC0Textures'),
    (SKIMAGE + 'grass.png', 'CC0-1.0', 'CC0Textures'),
    (SKIMAGE + 'gravel.png', 'CC0-1.0', 'CC0Textures'),
    (SCIPY + 'ascent.dat', 'public domain', ''),
]
VALIDATION = [
    (LOMIRI + 'Picture_1A_by_freespace.jpg', 'CC-BY-4.0', 'Trevor "Freespace"'),
    (SKLEARN + 'flower.jpg', 'CC-BY-2.0', 'vultilion'),
    (SKIMAGE + 'coffee.png', 'CC0-1.0', 'Rachel Michetti'),
]
LARGEST_SIDE = 2600
SMALLEST_SIDE = 260


def read_grey(path):
    if path.endswith('.dat'):  # a pickled list of rows
        with open(path, 'rb') as file:
            return np.array(pickle.load(file), np.float32)
    return cv2.imread(path, cv2.IMREAD_GRAYSCALE).astype(np.float32)


def pyramid(photo):
    """The photo in several sizes, so that its texture comes coarse and fine."""
    factor = min(1.0, LARGEST_SIDE / max(photo.shape))
    levels = []
    while factor * min(photo.shape) >= SMALLEST_SIDE:
        levels.append(cv2.resize(photo, None, fx=factor, fy=factor, interpolation=cv2.INTER_AREA))
        factor *= 0.7
    return levels


def load(folder, files):
    """Pyramids of the photos of packages that were unpacked into `folder`."""
    return [pyramid(read_grey(os.path.join(folder, name))) for name, _, _ in files]
