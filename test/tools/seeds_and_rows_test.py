#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""make_seeds, warp_rows, and what match makes of their output."""
import os
import tempfile
import unittest

import cv2
import numpy as np

from support import rendered_pair, read_pfm, run, write_pfm


class SeedsAndRowsTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        left, right, self.truth = rendered_pair(height=160, width=240)
        self.left, self.right = self.path("left.png"), self.path("right.png")
        cv2.imwrite(self.left, left)
        cv2.imwrite(self.right, right)

    def tearDown(self):
        self.folder.cleanup()

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def ok(self, tool, *arguments):
        code, out, err = run(tool, *arguments, "--overwrite")
        self.assertEqual(code, 0, err)
        return out

    def match(self, right, *options):
        self.ok("match", self.left, right, "--output", self.path("d.pfm"), "--num-disparities", 16, "--fill", *options)
        return np.mean(np.abs(read_pfm(self.path("d.pfm")) - self.truth)[:, 16:] > 1.0)

    def test_made_seeds_lie_on_the_truth(self):
        write_pfm(self.path("truth.pfm"), self.truth)
        arguments = ["make_seeds", self.path("truth.pfm"), "--num-disparities", 16, "--seed-share", 0.02]
        self.ok(*arguments, "--output", self.path("a.txt"), "--seed-noise", 0, "--seed-outliers", 0)
        seeds = np.loadtxt(self.path("a.txt"))
        self.assertGreater(len(seeds), 500)
        np.testing.assert_allclose(seeds[:, 2], self.truth[seeds[:, 1].astype(int), seeds[:, 0].astype(int)])
        self.ok(*arguments, "--output", self.path("b.txt"))
        self.ok(*arguments, "--output", self.path("c.txt"))
        with open(self.path("b.txt")) as b, open(self.path("c.txt")) as c:
            self.assertEqual(b.read(), c.read())

    def test_seeds_carry_depth_where_the_images_show_none(self):
        blank = np.full((160, 240), 128, np.uint8)
        cv2.imwrite(self.left, blank)
        cv2.imwrite(self.right, blank)
        write_pfm(self.path("truth.pfm"), np.tile(np.linspace(3, 12, 240, dtype=np.float32), (160, 1)))
        self.truth = read_pfm(self.path("truth.pfm"))
        self.ok("make_seeds", self.path("truth.pfm"), "--num-disparities", 16, "--output", self.path("s.txt"))
        self.assertGreater(self.match(self.right), 0.5)
        self.assertLess(self.match(self.right, "--seeds", self.path("s.txt")), 0.05)

    def test_aligned_rows_are_as_good_as_straight_ones(self):
        self.ok("warp_rows", self.right, "--output", self.path("w.png"), "--shift", 1.5, "--across", 0.8)
        straight = self.match(self.right)
        self.assertGreater(self.match(self.path("w.png"), "--set", "row_alignment.enabled=false"), straight + 0.02)
        self.assertLess(self.match(self.path("w.png")), straight + 0.01)

    def test_pictures(self):
        self.match(self.right, "--draw-seeds", self.path("s.png"), "--row-alignment", self.path("r.png"))
        for name in ("s.png", "r.png"):
            picture = cv2.imread(self.path(name))
            self.assertEqual(picture.shape, (160, 240, 3))
            self.assertGreater(picture.std(), 5.0)

    def test_inputs_and_files_of_others_stay(self):
        write_pfm(self.path("truth.pfm"), self.truth)
        for arguments in (["make_seeds", self.path("truth.pfm"), "--output", self.path("truth.pfm"), "--overwrite"],
                          ["warp_rows", self.left, "--output", self.left, "--overwrite"],
                          ["warp_rows", self.left, "--output", self.right],
                          ["make_seeds", self.path("truth.pfm"), "--output", self.right],
                          ["make_seeds", self.path("truth.pfm"), "--output", self.path("no/folder.txt")]):
            code, out, err = run(*arguments)
            self.assertEqual((code, out, err.count("\n")), (1, "", 1), err)

    def test_bad_usage_is_refused(self):
        for arguments in (["make_seeds", self.left, "--output", self.path("s.txt"), "--seed-share", 2],
                          ["warp_rows", self.left]):
            code, out, err = run(*arguments)
            self.assertEqual((code, out, err.count("\n")), (2, "", 1), err)


if __name__ == "__main__":
    unittest.main()
