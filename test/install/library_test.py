#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""The core as an installed library: the example of examples/ is built against it, as it stands, and run."""
import os
import re
import subprocess
import tempfile
import unittest

BUILD = os.environ["FDP_STEREO_BUILD"]
SOURCE = os.environ["FDP_STEREO_SOURCE"]
SAMPLE = os.path.join(SOURCE, "sample", "motorcycle")
CLEAN = {"PATH": "/usr/bin:/bin", "LANG": "C.UTF-8"}


def package_version():
    with open(os.path.join(SOURCE, "package.xml")) as file:
        return re.search(r"<version>(.+)</version>", file.read()).group(1)


class LibraryTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.prefix = cls.path("prefix")
        subprocess.run(["cmake", "--install", BUILD, "--prefix", cls.prefix], check=True, stdout=subprocess.DEVNULL)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder.name, name)

    def run_clean(self, *words, code=0):
        done = subprocess.run(words, env=CLEAN, cwd=self.folder.name, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, timeout=300)
        self.assertEqual(done.returncode, code, done.stdout[-3000:])
        return done.stdout

    def configure(self, source, build):
        return self.run_clean("cmake", "-S", source, "-B", self.path(build), "-DCMAKE_PREFIX_PATH=" + self.prefix,
                              "-DCMAKE_BUILD_TYPE=Release")

    def test_the_example_builds_and_runs(self):
        self.configure(os.path.join(SOURCE, "examples"), "build")
        self.run_clean("cmake", "--build", self.path("build"))
        program, disparity = self.path("build/match_two_images"), self.path("disparity.pfm")
        pair = [os.path.join(SAMPLE, name) for name in ("left.png", "right.png")]
        self.assertEqual(self.run_clean(program, *pair, disparity), "")
        with open(disparity, "rb") as file:
            self.assertEqual(file.read(15), b"Pf\n741 500\n-1.0")
        self.assertIn("usage", self.run_clean(program, code=2))
        self.assertRegex(self.run_clean(program, "none.png", pair[1], disparity, code=1), "match_two_images: none.png.*")

    def test_the_version_is_that_of_the_package(self):
        os.mkdir(self.path("outside"))
        with open(self.path("outside/CMakeLists.txt"), "w") as file:
            file.write("cmake_minimum_required(VERSION 3.16)\nproject(outside CXX)\nfind_package(fdp_stereo %s REQUIRED)\n"
                       "message(STATUS found=${fdp_stereo_VERSION})\n" % package_version())
        self.assertIn("found=" + package_version() + "\n", self.configure(self.path("outside"), "outside_build"))

    def test_the_shared_library_has_a_version(self):
        found = [name for _, _, names in os.walk(self.prefix) for name in names if name.startswith("libfdp_stereo_core.so")]
        major_minor = package_version().rsplit(".", 1)[0]
        self.assertEqual(sorted(found), ["libfdp_stereo_core.so" + end
                                         for end in ("", "." + major_minor, "." + package_version())])

    def test_the_readme_shows_the_example(self):
        with open(os.path.join(SOURCE, "examples", "match_two_images.cpp")) as file:
            body = re.search(r"  fdp_stereo::PipelineParams.*?writeDisparity[^\n]*\n", file.read(), re.S).group(0)
        with open(os.path.join(SOURCE, "README.md")) as file:
            self.assertIn(re.sub(r"^  ", "", body, flags=re.M), file.read())


if __name__ == "__main__":
    unittest.main()
