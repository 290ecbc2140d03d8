#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""The page of evaluate --report in headless Chromium, driven through chromedriver's WebDriver interface."""
import json
import os
import re
import shutil
import subprocess
import tempfile
import time
import unittest
import urllib.request

from support import run, write_scene

ELEMENT = "element-6066-11e4-a52e-4f735466cecf"


class Browser:
    """A WebDriver session; the browser sees no network but the loopback of its driver."""

    def __init__(self, folder):
        log = os.path.join(folder, "chromedriver.log")
        self.log = open(log, "w+")
        self.driver = subprocess.Popen(["chromedriver", "--port=0"], stdout=self.log, stderr=subprocess.STDOUT)
        for _ in range(300):
            with open(log) as text:
                port = re.search(r"successfully on port (\d+)", text.read())
            if port:
                break
            time.sleep(0.1)
        self.base = "http://127.0.0.1:%s" % port.group(1)
        options = {"args": ["--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--window-size=1400,1600",
                            "--user-data-dir=" + os.path.join(folder, "profile")]}
        session = self.call("POST", "/session", {"capabilities": {"alwaysMatch": {
            "browserName": "chrome", "goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}}})
        self.session = "/session/" + session["sessionId"]

    def call(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.base + path, data, {"Content-Type": "application/json"}, method=method)
        with urllib.request.urlopen(request, timeout=60) as answer:
            return json.load(answer)["value"]

    def open(self, url):
        self.call("POST", self.session + "/url", {"url": url})

    def script(self, code):
        return self.call("POST", self.session + "/execute/sync", {"script": code, "args": []})

    def click(self, css):
        found = self.call("POST", self.session + "/element", {"using": "css selector", "value": css})
        self.call("POST", "%s/element/%s/click" % (self.session, found[ELEMENT]), {})

    def messages(self):
        return self.call("POST", self.session + "/se/log", {"type": "browser"})

    def close(self):
        self.call("DELETE", self.session)
        self.driver.terminate()
        self.driver.wait(30)
        self.log.close()


@unittest.skipUnless(shutil.which("chromedriver"), "chromedriver is not installed (scripts/setup.sh --test)")
class ReportPageTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        scenes = [os.path.join(cls.folder, "scenes", name) for name in ("one & <two>", "three")]
        for seed, scene in enumerate(scenes):
            write_scene(scene, seed)
        code, _, err = run("evaluate", *scenes, "--preset", "fast", "--preset", "paper", "--peers", "--report",
                           os.path.join(cls.folder, "report"))
        assert code == 0, err
        cls.browser = Browser(cls.folder)
        cls.browser.open("file://" + os.path.join(cls.folder, "report", "index.html"))

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()
        shutil.rmtree(cls.folder)

    def column(self, table, index):
        return self.browser.script("return [...document.querySelectorAll('#%s tbody tr')].map("
                                   "row => row.children[%d].textContent)" % (table, index))

    def test_1_tables_are_filled(self):
        self.assertEqual(self.column("means", 0), ["fast", "paper", "sgbm_hh", "sgbm_3way", "bm"])
        self.assertEqual(len(self.column("scenes", 0)), 10)
        self.assertEqual(self.column("compare", 0), ["one & <two>", "three", "mean"])

    def test_2_the_best_of_a_column_is_marked(self):
        marked = self.browser.script("return [...document.querySelectorAll('#means tbody tr')].map("
                                     "row => row.children[5].classList.contains('best'))")
        values = [float(value) for value in self.column("means", 5)]
        self.assertEqual(marked, [value == min(values) for value in values])

    def test_2_where_all_are_equal_none_is_marked(self):
        best = self.browser.script("return [...document.querySelectorAll('#scenes tbody tr')].map(row => "
                                   "[row.children[0].textContent, row.children[7].textContent,"
                                   " row.children[7].classList.contains('best')])")
        for scene in {row[0] for row in best}:
            densities = {row[1] for row in best if row[0] == scene}
            marked = [row for row in best if row[0] == scene and row[2]]
            self.assertEqual(bool(marked), len(densities) > 1, scene)

    def test_2_the_command_is_told(self):
        command = self.browser.script("return document.getElementById('command').textContent")
        self.assertRegex(command, r"^evaluate .*--preset fast --preset paper --peers")

    def test_3_a_click_sorts_and_a_second_one_turns_round(self):
        self.browser.click("#means th:nth-child(6)")
        ascending = [float(value) for value in self.column("means", 5)]
        self.assertEqual(ascending, sorted(ascending))
        self.browser.click("#means th:nth-child(6)")
        self.assertEqual([float(value) for value in self.column("means", 5)], ascending[::-1])
        self.browser.click("#means th:nth-child(1)")
        self.assertEqual(self.column("means", 0), ["bm", "fast", "paper", "sgbm_3way", "sgbm_hh"])

    def test_4_the_metric_can_be_chosen(self):
        before = self.column("compare", 1)
        self.browser.script("const select = document.getElementById('metric'); select.selectedIndex = 0;"
                            "select.dispatchEvent(new Event('change'))")
        self.assertNotEqual(self.column("compare", 1), before)

    def test_5_every_picture_loads(self):
        self.browser.script("document.querySelectorAll('details').forEach(part => part.open = true);"
                            "document.querySelectorAll('img').forEach(image => image.loading = 'eager')")
        for _ in range(100):
            pending = self.browser.script("return [...document.images].filter(image => !image.complete).length")
            if pending == 0:
                break
            time.sleep(0.1)
        widths = self.browser.script("return [...document.images].map(image => image.naturalWidth)")
        self.assertGreaterEqual(len(widths), 2 * (2 + 5 * 3))
        self.assertEqual(set(widths), {110})

    def test_6_the_console_is_silent_and_the_network_unused(self):
        self.assertEqual(self.browser.messages(), [])
        self.assertEqual(self.browser.script(
            "return performance.getEntriesByType('resource').map(entry => entry.name)"
            ".filter(name => !name.startsWith('file:') && !name.startsWith('data:'))"), [])

    def test_7_corrupted_images_have_a_table_of_their_own(self):
        hidden = "return document.getElementById('robustness').hidden"
        self.assertTrue(self.browser.script(hidden))
        report = os.path.join(self.folder, "spoilt")
        code, _, err = run("evaluate", os.path.join(self.folder, "scenes", "three"), "--preset", "light", "--peers",
                           "--corrupt", "none", "--corrupt", "dark", "--report", report)
        self.assertEqual(code, 0, err)
        self.browser.open("file://" + os.path.join(report, "index.html"))
        self.assertFalse(self.browser.script(hidden))
        self.assertEqual(self.column("ratios", 0), ["none", "dark"])
        self.assertEqual(self.column("compare", 0), ["three", "three+dark", "mean", "mean+dark"])
        self.assertIn("quarter of the light", self.browser.script("return document.getElementById('images').textContent"))
        self.assertEqual(self.browser.messages(), [])


if __name__ == "__main__":
    unittest.main()
