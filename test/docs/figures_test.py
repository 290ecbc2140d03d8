#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""Figures of README and docs/performance.md are those that were measured; README is short, and all pages are near it."""
import collections
import glob
import json
import os
import re
import sys
import unittest

ROOT = os.environ["FDP_STEREO_SOURCE"]
sys.path.insert(0, os.path.join(ROOT, "scripts"))
import update_readme  # noqa: E402

LINK = re.compile(r"\]\((?!https?:|#)([^)#]+\.md)")
UNIT = re.compile(r"\d[\d.]*\s*(?:%|ms\b|Hz\b|MB\b|times\b|fps\b)")


def read(path):
    with open(os.path.join(ROOT, path)) as file:
        return file.read()


class FiguresTest(unittest.TestCase):
    def setUp(self):
        self.measured = json.loads(read("docs/measured.json"))

    def test_pages_tell_what_was_measured(self):
        self.assertEqual(update_readme.update(self.measured, check=True), [])

    def test_an_edited_figure_is_found(self):
        block = re.search(update_readme.BLOCK % ("summary", "summary"), read("README.md"), flags=re.S).group(0)
        self.assertRegex(block, UNIT)
        for figure in re.findall(r"\d+\.\d+", block):
            edited = block.replace(figure, "%.1f" % (float(figure) + 1))
            self.assertNotIn(edited, update_readme.rendered("README.md", self.measured))

    def test_readme_has_no_other_figures(self):
        rest = re.sub(update_readme.BLOCK % ("summary", "summary"), "", read("README.md"), flags=re.S)
        self.assertEqual(UNIT.findall(re.sub(r"```.*?```", "", rest, flags=re.S)), [])

    def test_readme_is_short(self):
        self.assertLessEqual(len(read("README.md").splitlines()), 120)

    def test_every_page_is_two_links_from_readme(self):
        distance = {"README.md": 0}
        queue = collections.deque(distance)
        while queue:
            page = queue.popleft()
            for link in LINK.findall(read(page)):
                target = os.path.relpath(os.path.join(ROOT, os.path.dirname(page), link), ROOT)
                if target not in distance and os.path.exists(os.path.join(ROOT, target)):
                    distance[target] = distance[page] + 1
                    queue.append(target)
        for path in glob.glob(os.path.join(ROOT, "docs", "*.md")):
            self.assertLessEqual(distance.get(os.path.relpath(path, ROOT), 99), 2, path)

    def test_bandwidth_is_computed_from_sizes(self):
        """docs/scale.md: bytes per px x px x 15 Hz; thinned topics round up to whole squares."""
        rows = re.findall(r"^\| [^|]+ \| (\d+)(?:/(\d+))? \| ([\d.]+) \| ([\d.]+) \|$", read("docs/scale.md"), flags=re.M)
        self.assertEqual(len(rows), 7)
        for size, square, *told in rows:
            side = round(int(square or 1) ** 0.5)
            for text, (width, height) in zip(told, ((640, 480), (1280, 720))):
                count = -(-width // side) * -(-height // side)
                self.assertEqual(text, "%.1f" % (int(size) * count * 15 / 1e6))


if __name__ == "__main__":
    unittest.main()
