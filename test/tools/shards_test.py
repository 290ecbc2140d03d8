#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""The job file of docs/scale.md under GNU parallel: the parts put together are all scenes."""
import os
import shutil
import subprocess
import tempfile
import unittest

from support import BIN, run, write_scene

JOB = os.path.join(os.environ["FDP_STEREO_SOURCE"], "examples", "evaluate.sbatch")


@unittest.skipIf(shutil.which("parallel") is None, "GNU parallel is not installed")
class ShardsTest(unittest.TestCase):
    def test_parts_of_gnu_parallel(self):
        with tempfile.TemporaryDirectory() as folder:
            scenes, report = os.path.join(folder, "scenes"), os.path.join(folder, "report")
            for seed in range(3):
                write_scene(os.path.join(scenes, "scene%d" % seed), seed)
            environment = dict(os.environ, EVALUATE=os.path.join(BIN, "evaluate"), PARALLEL_HOME=folder)
            command = "SLURM_ARRAY_TASK_COUNT=2 parallel --will-cite SLURM_ARRAY_TASK_ID={} %s %s %s ::: 1 2" % (
                JOB, scenes, report)
            done = subprocess.run(["bash", "-c", command], env=environment, stdin=subprocess.DEVNULL,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=120)
            self.assertEqual(done.returncode, 0, done.stdout)
            code, out, err = run("evaluate", "--merge", "--report", report)
            self.assertEqual(code, 0, err)
            for seed in range(3):
                self.assertIn("scene%d" % seed, out)


if __name__ == "__main__":
    unittest.main()
