#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""match as a user meets it: outputs, options, error lines and exit codes."""
import json
import os
import tempfile
import unittest

import cv2
import numpy as np

from support import rendered_pair, read_pfm, run, write_pfm


class MatchTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        left, right, self.truth = rendered_pair()
        self.left, self.right = self.path("left.png"), self.path("right.png")
        cv2.imwrite(self.left, left)
        cv2.imwrite(self.right, right)

    def tearDown(self):
        self.folder.cleanup()

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def match(self, *options, output="d.pfm"):
        code, out, err = run("match", self.left, self.right, "--output", self.path(output), "--num-disparities", 16,
                             *options)
        self.assertEqual(code, 0, err)
        self.assertEqual(err, "")
        return out

    def refused(self, code, part, *arguments):
        actual, out, err = run("match", *arguments)
        self.assertEqual(actual, code, err)
        self.assertEqual(out, "")
        self.assertEqual(err.count("\n"), 1, err)
        self.assertTrue(err.startswith("match: "), err)
        self.assertIn(part, err)

    def test_finds_the_rendered_disparities(self):
        self.match("--fill")
        disparity = read_pfm(self.path("d.pfm"))
        self.assertEqual(disparity.shape, self.truth.shape)
        self.assertTrue(np.isfinite(disparity).all())
        error = np.abs(disparity - self.truth)[:, 16:]
        self.assertLess(np.mean(error > 1.0), 0.06)
        self.assertLess(np.median(error), 0.15)

    def test_marks_what_it_does_not_know(self):
        self.match()
        disparity = read_pfm(self.path("d.pfm"))
        self.assertTrue(np.isinf(disparity).any())
        self.assertFalse(np.isnan(disparity).any())

    def test_png_holds_the_same_to_256ths(self):
        self.match()
        self.match(output="d.png")
        raw = cv2.imread(self.path("d.png"), cv2.IMREAD_UNCHANGED)
        self.assertEqual(raw.dtype, np.uint16)
        disparity = read_pfm(self.path("d.pfm"))
        known = np.isfinite(disparity)
        self.assertTrue(((raw > 0) == known).all())
        self.assertLessEqual(np.abs(raw[known] / 256.0 - disparity[known]).max(), 0.51 / 256)

    def test_writes_pictures_and_timings(self):
        self.match("--color", self.path("c.png"), "--confidence", self.path("f.png"), "--timings", self.path("t.json"))
        color = cv2.imread(self.path("c.png"))
        none = np.isinf(read_pfm(self.path("d.pfm")))
        self.assertEqual(color.shape, self.truth.shape + (3,))
        self.assertTrue((color[none] == 0).all())
        self.assertEqual(cv2.imread(self.path("f.png"), cv2.IMREAD_UNCHANGED).dtype, np.uint8)
        with open(self.path("t.json")) as file:
            timings = json.load(file)
        self.assertEqual((timings["width"], timings["height"]), self.truth.shape[::-1])
        names = [stage["stage"] for stage in timings["stages"]]
        self.assertIn("matching_cost", names)
        self.assertAlmostEqual(timings["total_ms"], sum(stage["ms"] for stage in timings["stages"]), places=2)
        self.assertGreater(timings["peak_memory_mb"], 1.0)
        self.assertAlmostEqual(timings["valid_share"], 1.0 - none.mean(), places=4)

    def test_confidence_as_pfm_is_between_0_and_1(self):
        self.match("--confidence", self.path("f.pfm"))
        confidence = read_pfm(self.path("f.pfm"))
        self.assertGreaterEqual(confidence.min(), 0.0)
        self.assertLessEqual(confidence.max(), 1.0)
        self.assertGreater(confidence.max(), confidence.min())

    def test_one_and_two_threads_agree_to_the_bit(self):
        for preset in ("fast", "paper"):
            self.match("--threads", 1, "--preset", preset)
            one = read_pfm(self.path("d.pfm"))
            self.match("--threads", 2, "--preset", preset)
            np.testing.assert_array_equal(one, read_pfm(self.path("d.pfm")))

    def test_parameters_come_from_yaml_and_the_command_line(self):
        preset = self.path("mine.yaml")
        with open(preset, "w") as file:
            file.write("optimizer.type: winner_takes_all\nweighted_median: {radius: 0}\n")
        self.match("--preset", preset)
        from_yaml = read_pfm(self.path("d.pfm"))
        self.match("--preset", preset, "--set", "optimizer.type=semi_global")
        self.assertFalse(np.array_equal(from_yaml, read_pfm(self.path("d.pfm"))))

    def test_negative_disparities(self):
        cv2.imwrite(self.right, np.roll(cv2.imread(self.left), 5, axis=1))
        self.match("--min-disparity", -12)
        disparity = read_pfm(self.path("d.pfm"))
        self.assertAlmostEqual(np.median(disparity[np.isfinite(disparity)]), -5.0, delta=0.1)

    def test_seeds_of_a_file_are_counted(self):
        seeds = self.path("seeds.txt")
        with open(seeds, "w") as file:
            file.write("60 30 9\n20 30 4 0.9\n1000 1000 9\n")
        self.match("--seeds", seeds, "--timings", self.path("t.json"), "--set", "row_alignment.enabled=false", "--preset",
                   "paper")
        with open(self.path("t.json")) as file:
            self.assertGreaterEqual(json.load(file)["seeds"], 2)

    def test_lists_every_parameter(self):
        code, out, _ = run("match", "--list-parameters")
        self.assertEqual(code, 0)
        self.assertIn("matching_cost.type = ", out)
        code, out, _ = run("match", "--help")
        self.assertEqual(code, 0)
        self.assertIn("paper", out)

    def test_wrong_usage_is_one_line_and_2(self):
        output = ("--output", self.path("d.pfm"))
        self.refused(2, "required")
        self.refused(2, "required", self.left, self.right)
        self.refused(2, "'matching_cost.alpha'", self.left, self.right, *output, "--set", "matching_cost.alhpa=1")
        self.refused(2, "1 to 1024", self.left, self.right, *output, "--num-disparities", 0)
        self.refused(2, "Could not convert", self.left, self.right, *output, "--num-disparities", "many")
        self.refused(2, "unknown preset 'best'", self.left, self.right, *output, "--preset", "best")
        self.refused(2, "--nonsense", self.left, self.right, *output, "--nonsense")
        self.refused(2, "local_expansion", self.left, self.right, *output, "--log-energy")

    def test_bad_input_is_one_line_and_1(self):
        output = ("--output", self.path("d.pfm"))
        self.refused(1, "none.png: missing", self.path("none.png"), self.right, *output)
        self.refused(1, "cannot be written", self.left, self.right, "--output", "/does/not/exist/d.pfm")
        self.refused(1, ".pfm or .png", self.left, self.right, "--output", self.path("d.tiff"))
        small = self.path("small.png")
        cv2.imwrite(small, np.zeros((10, 20, 3), np.uint8))
        self.refused(1, "20", self.left, small, *output)
        with open(small, "r+b") as file:
            file.truncate(40)
        self.refused(1, "truncated PNG", small, self.right, *output)
        floats = self.path("floats.pfm")
        write_pfm(floats, self.truth)
        self.refused(1, "not PNG, JPEG, TIFF", floats, self.right, *output)
        floats = self.path("floats.tiff")
        cv2.imwrite(floats, self.truth)
        self.refused(1, "8 or 16 bits", floats, self.right, *output)


if __name__ == "__main__":
    unittest.main()
