#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""match as a user meets it: outputs, options, error lines and exit codes."""
import json
import os
import re
import resource
import subprocess
import tempfile
import unittest

import cv2
import numpy as np

from support import BIN, rendered_pair, read_pfm, run, write_pfm


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
                             "--overwrite", *options)
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
        out = self.match("--seeds", seeds)
        self.assertIn("warning: 1 of 3 seeds are outside the image, 110 x 60 px", out)
        self.match("--seeds", seeds, "--timings", self.path("t.json"), "--set", "row_alignment.enabled=false", "--preset",
                   "paper")
        with open(self.path("t.json")) as file:
            self.assertGreaterEqual(json.load(file)["seeds"], 2)

    def test_seeds_of_another_size_are_refused(self):
        write_pfm(self.path("half.pfm"), self.truth[::2, ::2])
        self.refused(1, "half.pfm: is 55 x 30 px, the left image 110 x 60 px", self.left, self.right, "--output",
                     self.path("d.pfm"), "--seeds", self.path("half.pfm"))

    def test_masks_leave_pixels_out(self):
        mask = np.zeros(self.truth.shape, np.uint8)
        mask[10:30, 40:70] = 255
        cv2.imwrite(self.path("mask.png"), mask)
        self.match("--fill", "--left-mask", self.path("mask.png"))
        disparity = read_pfm(self.path("d.pfm"))
        self.assertTrue(np.isinf(disparity[10:30, 40:70]).all())
        self.assertTrue(np.isfinite(disparity[mask == 0]).all())
        cv2.imwrite(self.path("small.png"), mask[:20])
        self.refused(1, "small.png: a mask of", self.left, self.right, "--output", self.path("e.pfm"), "--right-mask",
                     self.path("small.png"))

    def test_exchanged_views_are_told(self):
        left, right, _ = rendered_pair(height=160, width=240)
        cv2.imwrite(self.left, left)
        cv2.imwrite(self.right, right)
        self.assertNotIn("exchange", self.match())
        self.left, self.right = self.right, self.left
        for options in ([], ["--fill"]):
            self.assertIn("exchange LEFT and RIGHT", self.match(*options))

    def test_a_range_outside_the_image_is_refused(self):
        for smallest in (110, 900, -130):
            self.refused(1, "set --min-disparity near 0", self.left, self.right, "--output", self.path("d.pfm"),
                         "--num-disparities", 16, "--min-disparity", smallest)

    def test_images_come_through_pipes(self):
        self.match()
        expected = read_pfm(self.path("d.pfm"))
        command = "'%s' <(cat '%s') <(cat '%s') -o '%s' --num-disparities 16" % (
            os.path.join(BIN, "match"), self.left, self.right, self.path("p.pfm"))
        subprocess.run(["bash", "-c", command], check=True, stdout=subprocess.DEVNULL)
        np.testing.assert_array_equal(read_pfm(self.path("p.pfm")), expected)

    def test_inputs_and_files_of_others_stay(self):
        seeds = self.path("seeds.txt")
        with open(seeds, "w") as file:
            file.write("60 30 9\n")
        os.symlink(self.left, self.path("link.png"))
        for path in (self.left, self.right, self.path("link.png")):
            self.refused(1, "is an input", self.left, self.right, "--output", path, "--overwrite")
        self.refused(1, "is an input", self.left, self.right, "--output", self.path("d.pfm"), "--timings", seeds, "--seeds",
                     seeds, "--overwrite")
        with open(self.path("mine.png"), "w") as file:
            file.write("mine")
        for option in ("--color", "--confidence", "--draw-seeds", "--row-alignment", "--timings"):
            self.refused(1, "exists already", self.left, self.right, "--output", self.path("d.pfm"), option,
                         self.path("mine.png"))
        self.refused(1, "two outputs", self.left, self.right, "-o", self.path("d.png"), "--color", self.path("d.png"))
        self.assertFalse(os.path.exists(self.path("d.pfm")))
        self.match("--color", self.path("mine.png"))
        self.assertIsNotNone(cv2.imread(self.path("mine.png")))
        self.assertEqual([name for name in os.listdir(self.folder.name) if "partial" in name], [])

    def test_outputs_are_checked_before_the_work(self):
        for output, part in (("/does/not/exist/d.pfm", "there is no folder"), (self.path("d.tif"), ".pfm or .png"),
                             (self.path("d"), ".pfm or .png"), (self.folder.name, ".pfm or .png")):
            self.refused(1, part, self.path("none.png"), self.right, "--output", output)
        for option in ("--color", "--draw-seeds", "--row-alignment", "--confidence"):
            self.refused(1, "c.xyz: must be", self.path("none.png"), self.right, "--output", self.path("d.pfm"), option,
                         self.path("c.xyz"))

    def test_devices_can_be_written(self):
        _, out, _ = run("match", self.left, self.right, "-o", self.path("e.pfm"), "--timings", "/dev/stdout")
        self.assertIn('"total_ms"', out)

    def test_version(self):
        with open(os.path.join(os.environ["FDP_STEREO_SOURCE"], "package.xml")) as file:
            version = re.search("<version>(.+)</version>", file.read()).group(1)
        for tool in ("match", "evaluate", "make_seeds", "warp_rows", "process_bag", "images_to_bag", "demo_report",
                     "latency_probe"):
            if os.path.exists(os.path.join(BIN, tool)):
                code, out, _ = run(tool, "--version")
                self.assertEqual((code, out), (0, "%s (fdp_stereo) %s\n" % (tool, version)))

    def test_out_of_memory_is_a_line(self):
        """An error, no signal, at any limit; below what the libraries themselves need, the loader tells."""
        left, right, _ = rendered_pair(height=600, width=800)
        cv2.imwrite(self.left, left)
        cv2.imwrite(self.right, right)
        limits_mb = {"fast": (100, 150, 200, 250, 300, 350, 400, 450, 500, 600), "accurate": (250, 400), "paper": (250, 400)}
        for preset, limits in limits_mb.items():
            for limit_mb in limits:
                done = subprocess.run(
                    [os.path.join(BIN, "match"), self.left, self.right, "-o", self.path("o.pfm"), "--overwrite", "--preset",
                     preset, "--num-disparities", "200", "--set", "local_expansion.iterations=0"],
                    stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=600,
                    preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit_mb << 20, limit_mb << 20)))
                with self.subTest(preset=preset, limit_mb=limit_mb):
                    self.assertGreaterEqual(done.returncode, 0, "ended by a signal: " + done.stderr)
                    if done.returncode != 0:
                        self.assertNotEqual(done.stderr, "")

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
