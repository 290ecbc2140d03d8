#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""evaluate against a scoring of its own here, and what it does with broken, interrupted and divided runs."""
import csv
import os
import resource
import subprocess
import tempfile
import unittest

import cv2
import numpy as np

from support import BIN, read_pfm, run, write_scene

BAD = {"bad_0.125": 0.125, "bad_0.25": 0.25, "bad_0.5": 0.5, "bad_1": 1.0, "bad_2": 2.0, "bad_3": 3.0}


def score(disparity, truth, region):
    """The figures of one map, straight from their definition."""
    use = np.isfinite(truth) & region
    answered = np.isfinite(disparity) & (disparity >= 0)
    error = np.where(answered, np.abs(np.where(answered, disparity, 0) - np.where(use, truth, 0)), np.inf)[use]
    figures = {name: 100.0 * np.mean(error > limit) for name, limit in BAD.items()}
    figures["d1"] = 100.0 * np.mean((error > 3.0) & (error > 0.05 * truth[use]))
    known = error[np.isfinite(error)]
    figures["density"] = 100.0 * len(known) / len(error)
    figures["sparse_bad_0.5"] = 100.0 * np.mean(known > 0.5)
    figures["average_px"] = np.minimum(known, 100.0).mean()
    figures["a95_px"] = np.sort(known)[int(np.ceil(0.95 * len(known))) - 1]
    return figures


def read_csv(path):
    with open(path, newline="") as file:
        return {(row["scene"], row["method"]): row for row in csv.DictReader(file)}


class EvaluateTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.scenes = [self.path("scenes/one"), self.path("scenes/two"), self.path("scenes/Playtable")]
        self.truths = [write_scene(scene, seed) for seed, scene in enumerate(self.scenes)]
        self.table, self.report = self.path("table.csv"), self.path("report")

    def tearDown(self):
        self.folder.cleanup()

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def evaluate(self, *arguments, code=0):
        actual, out, err = run("evaluate", *arguments, "--overwrite")
        self.assertEqual(actual, code, err)
        return out, err

    def test_figures_follow_their_definition(self):
        for options in ([], ["--fill"], ["--all"]):
            self.evaluate(*self.scenes, "--preset", "fast", "--preset", "paper", "--csv", self.table, *options)
            rows = read_csv(self.table)
            for preset in ("fast", "paper"):
                output = self.path("d.pfm")
                run("match", self.scenes[0] + "/im0.png", self.scenes[0] + "/im1.png", "--output", output,
                    "--num-disparities", 16, "--overwrite", "--preset", preset, *[o for o in options if o == "--fill"])
                truth, mask = self.truths[0]
                region = np.ones(mask.shape, bool) if "--all" in options else mask == 255
                for name, value in score(read_pfm(output), truth, region).items():
                    self.assertAlmostEqual(float(rows["one", preset][name]), value, places=4, msg=name)

    def test_the_mean_halves_the_scenes_that_middlebury_halves(self):
        out, _ = self.evaluate(*self.scenes, "--csv", self.table)
        rows = read_csv(self.table)
        weights = {"one": 1.0, "two": 1.0, "Playtable": 0.5}
        mean = sum(weight * float(rows[scene, "fast"]["bad_1"]) for scene, weight in weights.items()) / 2.5
        line = next(line for line in out.splitlines() if line.startswith("mean of 3"))
        self.assertAlmostEqual(float(line.split()[4 + 3]), mean, places=1)

    def test_a_folder_of_scenes_stands_for_them(self):
        self.evaluate(self.path("scenes"), "--csv", self.table)
        self.assertEqual({scene for scene, _ in read_csv(self.table)}, {"one", "two", "Playtable"})

    def test_goes_on_after_a_broken_scene_and_names_it(self):
        os.remove(self.scenes[0] + "/im1.png")
        with open(self.scenes[1] + "/disp0GT.pfm", "r+b") as file:
            file.truncate(100)
        out, err = self.evaluate(*self.scenes, self.path("none"), "--csv", self.table, code=1)
        self.assertIn("one/im1.png: missing", err)
        self.assertIn("disp0GT.pfm: truncated", err)
        self.assertIn("none: no such folder", err)
        _, again = self.evaluate(*self.scenes, self.path("none"), "--corrupt", "none", "--corrupt", "noise", code=1)
        for problem in ("one/im1.png: missing", "disp0GT.pfm: truncated", "none: no such folder"):
            self.assertEqual(again.count(problem), 1, "once, not with each kind")
        self.assertEqual(set(read_csv(self.table)), {("Playtable", "fast")})
        self.assertIn("mean of 1", out)

    def test_peers_and_variants_stand_beside_the_presets(self):
        self.evaluate(self.scenes[0], "--peers", "--preset", "fast", "--variant",
                      "wta=fast,optimizer.type=winner_takes_all", "--csv", self.table)
        rows = read_csv(self.table)
        self.assertEqual([method for _, method in rows], ["fast", "wta", "sgbm_hh", "sgbm_3way", "bm"])
        self.assertNotEqual(rows["one", "fast"]["bad_1"], rows["one", "wta"]["bad_1"])
        for method in ("sgbm_hh", "sgbm_3way", "bm"):
            self.assertLess(float(rows["one", method]["bad_2"]), 40.0)
            self.assertGreater(float(rows["one", method]["time_ms"]), 0.0)

    def test_scenes_may_follow_any_option(self):
        self.evaluate("--corrupt", "rows", "--preset", "fast", "--variant", "wta=fast,optimizer.type=winner_takes_all",
                      "--set", "semi_global.p1=0.5", "--csv", self.table, *self.scenes[:2])
        self.assertEqual(set(read_csv(self.table)),
                         {(scene, method) for scene in ("one+rows", "two+rows") for method in ("fast", "wta")})

    def test_corrupted_scenes_stand_beside_the_others(self):
        kinds = ("none", "noise", "dark", "gain", "gamma", "blur", "jpeg", "vignette", "saturation", "rows", "dirt")
        out, _ = self.evaluate(*self.scenes, "--peers", "--corrupt", "all", "--csv", self.table)
        rows = read_csv(self.table)
        name = {kind: "" if kind == "none" else "+" + kind for kind in kinds}
        self.assertEqual({scene for scene, _ in rows},
                         {scene + end for scene in ("one", "two", "Playtable") for end in name.values()})
        weights = {"one": 1.0, "two": 1.0, "Playtable": 0.5}
        table = [line.split() for line in out.split("bad 1 / that of sgbm_hh\n")[1].splitlines()]
        self.assertEqual(table[0], ["images", "fast", "sgbm_3way", "bm"])
        self.assertEqual([line[0] for line in table[1:]], list(kinds))
        for kind, *ratios in table[1:]:
            mean = {method: sum(weight * float(rows[scene + name[kind], method]["bad_1"])
                                for scene, weight in weights.items()) for method in (*table[0][1:], "sgbm_hh")}
            for method, ratio in zip(table[0][1:], ratios):
                self.assertAlmostEqual(float(ratio), mean[method] / mean["sgbm_hh"], delta=0.006)
        self.assertIn("mean of 3+noise", out)
        self.evaluate(*self.scenes, "--corrupt", "noise", "--corrupt", "none", "--corrupt", "NOISE", "--csv", self.table, "--jobs", 3)
        again = read_csv(self.table)
        self.assertEqual(len(again), 6)
        for key, row in again.items():
            for figure in (*BAD, "a95_px"):
                self.assertEqual(row[figure], rows[key][figure], key)

    def test_a_report_shows_corrupted_images(self):
        for shard in ("1/2", "2/2"):
            self.evaluate(self.scenes[0], "--peers", "--corrupt", "none", "--corrupt", "dark", "--corrupt", "rows",
                          "--report", self.report, "--shard", shard)
        out, _ = self.evaluate("--merge", "--report", self.report)
        self.assertIn("bad 1 / that of sgbm_hh", out)
        clean, dark = (cv2.imread(os.path.join(self.report, scene, "left.png")) for scene in ("one", "one+dark"))
        self.assertAlmostEqual(dark.mean() / clean.mean(), 0.25, delta=0.02)
        with open(os.path.join(self.report, "index.html")) as file:
            page = file.read()
        self.assertRegex(page, r'"robustness":{"kinds":\[{"images":"none","ratios":\[[\d.]+,[\d.]+,[\d.]+\]}')

    def limited(self, limit_mb, *arguments):
        return subprocess.run(
            [os.path.join(BIN, "evaluate"), *arguments], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE, text=True, timeout=100,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit_mb << 20, limit_mb << 20)))

    def test_out_of_memory_is_a_line(self):
        """An error, no signal and no endless wait, at any limit that the libraries start with."""
        starts = (mb for mb in range(60, 2000, 4) if self.limited(mb, "--version").returncode == 0)
        least = next(starts, None)
        if least is None:
            self.skipTest("a sanitizer needs all addresses")
        for limit_mb in (least, *(least + more for more in (2, 4, 8, 12, 16, 20, 30, 40, 80))):
            done = self.limited(limit_mb, *self.scenes, "--report", self.path("out_%d" % limit_mb))
            with self.subTest(limit_mb=limit_mb):
                self.assertGreaterEqual(done.returncode, 0, "ended by a signal: " + done.stderr)
                if done.returncode != 0:
                    self.assertNotEqual(done.stderr, "")
                    self.assertNotIn("bad_alloc", done.stderr)

    def test_writes_the_pictures(self):
        self.evaluate(self.scenes[0], "--report", self.report)
        for name in ("left", "truth", "fast_disparity", "fast_errors", "fast_invalid"):
            picture = cv2.imread(os.path.join(self.report, "one", name + ".png"))
            self.assertEqual(picture.shape[:2], self.truths[0][0].shape, name)

    def test_goes_on_where_an_interrupted_run_stopped(self):
        self.evaluate(*self.scenes, "--report", self.report)
        table = os.path.join(self.report, "results.csv")
        with open(table) as file:
            lines = file.read().splitlines()
        fields = lines[1].split(",")
        fields[2] = "77.5"
        with open(table, "w") as file:  # the first scene as if done before, with a mark; the others not yet
            file.write("\n".join([lines[0], ",".join(fields)]) + "\n")
        self.evaluate(*self.scenes, "--report", self.report)
        rows = read_csv(table)
        self.assertEqual(len(rows), 3)
        self.assertEqual(float(rows["one", "fast"]["bad_0.125"]), 77.5)
        self.evaluate(*self.scenes, "--report", self.report, "--set", "semi_global.p1=0.5")
        self.assertNotEqual(float(read_csv(table)["one", "fast"]["bad_0.125"]), 77.5, "other settings are done anew")

    def test_a_report_keeps_every_row(self):
        table = os.path.join(self.report, "results.csv")
        self.evaluate(self.scenes[0], "--report", self.report)
        self.evaluate(self.scenes[1], "--report", self.report)
        self.evaluate(self.scenes[0], "--report", self.report, "--preset", "paper", "--fill")
        self.assertEqual(set(read_csv(table)), {("one", "fast"), ("two", "fast"), ("one", "paper")})
        self.evaluate(self.scenes[0], "--report", self.report, "--fill")
        with open(table) as file:
            lines = file.read().splitlines()
        self.assertEqual(len(lines), 1 + 4, "filled and unfilled")
        with open(os.path.join(self.report, "index.html")) as file:
            page = file.read()
        self.assertIn("Rows of earlier runs", page)
        self.assertRegex(page, r'"method":"fast~\w{4}","scene":"two"')
        self.assertRegex(page, r'"method":"fast","scene":"one"')
        self.evaluate(*self.scenes[:2], "--report", self.report)
        with open(table) as file:
            self.assertEqual(file.read().splitlines(), lines, "nothing is run twice")

    def test_scenes_of_the_same_name_are_told_apart_by_their_pixels(self):
        other = self.path("others/one")
        write_scene(other, 77)
        self.evaluate(self.scenes[0], "--report", self.report)
        self.evaluate(other, "--report", self.report, "--csv", self.table)
        self.evaluate(other, "--csv", self.path("fresh.csv"))
        self.assertEqual(read_csv(self.table)["one", "fast"]["bad_1"],
                         read_csv(self.path("fresh.csv"))["one", "fast"]["bad_1"])

    def test_goes_on_after_a_cut_line(self):
        table = os.path.join(self.report, "results.csv")
        self.evaluate(*self.scenes, "--report", self.report)
        with open(table, "rb") as file:
            whole = file.read()
        for cut in (1, 10, 200):
            for tail in (b"", b"\0" * 50):
                with open(table, "wb") as file:
                    file.write(whole[:-cut] + tail)
                self.evaluate(*self.scenes, "--report", self.report)
                self.assertEqual(set(read_csv(table)), {(name, "fast") for name in ("one", "two", "Playtable")})
        with open(table, "wb") as file:
            file.write(whole[:20])
        self.evaluate(*self.scenes, "--report", self.report)
        self.assertEqual(len(read_csv(table)), 3)
        with open(table, "w") as file:
            file.write("somebody's own notes\n")
        _, err = self.evaluate(*self.scenes, "--report", self.report, code=1)
        self.assertIn("no table of this version", err)
        with open(table) as file:
            self.assertEqual(file.read(), "somebody's own notes\n")

    def test_files_of_others_stay(self):
        with open(self.table, "w") as file:
            file.write("mine")
        code, _, err = run("evaluate", self.scenes[0], "--csv", self.table)
        self.assertEqual(code, 1)
        self.assertIn("exists already", err)
        os.makedirs(self.report)
        with open(self.report + "/index.html", "w") as file:
            file.write("<title>mine</title>")
        _, err = self.evaluate(self.scenes[0], "--report", self.report, code=1)
        self.assertIn("no page of evaluate", err)
        _, err = self.evaluate(self.path("scenes"), "--report", self.path("scenes"), code=1)
        self.assertIn("folder of the scenes", err)
        self.assertFalse(os.path.exists(self.path("scenes/results.csv")))
        _, err = self.evaluate(self.path("scenes"), "--csv", self.path("no/table.csv"), code=1)
        self.assertIn("there is no folder", err)

    def test_shards_put_together_are_the_whole(self):
        whole, parts = self.path("whole"), self.path("parts")
        self.evaluate(*self.scenes, "--preset", "fast", "--preset", "paper", "--report", whole)
        for shard in ("1/2", "2/2"):
            self.evaluate(*self.scenes, "--preset", "fast", "--preset", "paper", "--report", parts, "--shard", shard)
        self.assertFalse(os.path.exists(parts + "/index.html"))
        self.evaluate("--merge", "--report", parts)
        expected, merged = read_csv(whole + "/results.csv"), read_csv(parts + "/results.csv")
        self.assertEqual(set(expected), set(merged))
        for key, row in expected.items():
            for name in BAD:
                self.assertEqual(row[name], merged[key][name])
        self.assertTrue(os.path.exists(parts + "/index.html"))

    def test_a_missing_shard_is_named(self):
        self.evaluate(*self.scenes, "--report", self.report, "--shard", "1/3")
        _, err = self.evaluate("--merge", "--report", self.report, code=1)
        self.assertIn("results-2-of-3.csv", err)

    def test_jobs_give_the_same_figures(self):
        self.evaluate(*self.scenes, "--csv", self.table)
        one = read_csv(self.table)
        self.evaluate(*self.scenes, "--csv", self.table, "--jobs", 3)
        three = read_csv(self.table)
        self.assertEqual(set(one), set(three))
        for key, row in one.items():
            for name in BAD:
                self.assertEqual(row[name], three[key][name])

    def test_wrong_usage_is_2(self):
        for part, arguments in (("required", []), ("NAME=PRESET", ["x", "--variant", "nothing"]),
                                ("unknown preset", ["x", "--preset", "fats"]),
                                ("two methods", ["x", "--preset", "fast", "--preset", "fast"]),
                                ("name of a method", ["x", "--variant", "a b=fast"]),
                                ("1 <= i <= n", ["x", "--shard", "3/2"]), ("--report", ["x", "--shard", "1/2"]),
                                ("--jobs", ["x", "--jobs", "0"]), ("'snow': must be one of none, noise", ["x", "--corrupt", "snow"]), ("--report", ["--merge"])):
            _, err = self.evaluate(*arguments, code=2)
            self.assertIn(part, err)
            self.assertEqual(err.count("\n"), 1, err)


if __name__ == "__main__":
    unittest.main()
