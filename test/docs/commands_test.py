#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs every bash block of README and docs from the root of the repository, as a reader would after scripts/build.sh;
build/ is the folder of the build that runs the test.

A block with `<!-- skip: reason -->` on the line before it is not run; its programs must exist all the same.
"""
import glob
import os
import re
import subprocess
import unittest

ROOT = os.environ["FDP_STEREO_SOURCE"]
BUILD = os.environ["FDP_STEREO_BUILD"]
BLOCK = re.compile(r"(?:<!-- skip: (?P<reason>[^>]+) -->\n)?```bash\n(?P<code>.*?)```", re.S)
LINK = re.compile(r"\]\((?!https?:|#)(?P<path>[^)#]+)")
PAGES = sorted(glob.glob(os.path.join(ROOT, "*.md")) + glob.glob(os.path.join(ROOT, "docs", "*.md")))


def blocks(page):
    with open(page) as file:
        return [(match["reason"], re.sub(r"\bbuild(?=/)", BUILD, match["code"])) for match in BLOCK.finditer(file.read())]


class CommandsTest(unittest.TestCase):
    def test_blocks_run(self):
        count = 0
        for page in PAGES:
            for reason, code in blocks(page):
                if reason:
                    continue
                count += 1
                done = subprocess.run(["bash", "-euo", "pipefail", "-c", code], cwd=ROOT, stdin=subprocess.DEVNULL,
                                      stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=1200)
                with self.subTest(page=os.path.relpath(page, ROOT), code=code):
                    self.assertEqual(done.returncode, 0, done.stdout[-2000:])
        self.assertGreater(count, 0)

    def test_programs_of_all_blocks_exist(self):
        for page in PAGES:
            for _, code in blocks(page):
                for program in re.findall(r"(?:scripts/[\w.]+|%s/devel/lib/fdp_stereo/\w+)" % re.escape(BUILD), code):
                    with self.subTest(page=os.path.relpath(page, ROOT), program=program):
                        self.assertTrue(os.access(os.path.join(ROOT, program), os.X_OK))

    def test_topics_and_parameters_of_the_node_are_described(self):
        page = ""
        for name in ("nodes.md", "points.md"):
            with open(os.path.join(ROOT, "docs", name)) as file:
                page += file.read()
        names = set()
        for source in ("disparity_nodelet.cpp", "output_topics.cpp", "seed_sources.cpp", "node_params.cpp",
                       "start_params.hpp", "points_nodelet.cpp", "point_params.cpp"):
            with open(os.path.join(ROOT, "src", "ros", source)) as file:
                text = file.read()
            names.update(re.findall(r'(?:advertise(?:Camera|Image)?|subscribe)(?:<[^>]+>)?\(\s*(?:node_, )?"([\w/]+)"', text))
            names.update(re.findall(r'(?:param(?:<[^>]+>)?|period|reader\.read|visit)\("(\w+)"', text))
            if source == "node_params.cpp":
                names.update(re.findall(r'{"(?:node|seeds)\.\w+".*?"(\w+)",\s*TuningStep::', text, flags=re.S))
        self.assertLessEqual({"disparity", "left/camera_info", "seeds/depth", "queue_size", "max_rate", "seeds_wait",
                              "free_space", "points_decimation"}, names)
        for name in sorted(names):
            with self.subTest(name=name):
                self.assertRegex(page, "`~?%s`" % name)

    def test_links_lead_somewhere(self):
        for page in PAGES:
            with open(page) as file:
                text = re.sub(r"```.*?```", "", file.read(), flags=re.S)
            for match in LINK.finditer(text):
                with self.subTest(page=os.path.relpath(page, ROOT), link=match["path"]):
                    self.assertTrue(os.path.exists(os.path.join(os.path.dirname(page), match["path"])))


if __name__ == "__main__":
    unittest.main()
