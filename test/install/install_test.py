#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""The install space: programs, and the nodelet in the demo's graph."""
import os
import re
import socket
import subprocess
import tempfile
import unittest

BUILD = os.environ["FDP_STEREO_BUILD"]
SOURCE = os.environ["FDP_STEREO_SOURCE"]
CLEAN = {"PATH": "/usr/bin:/bin", "HOME": tempfile.gettempdir(), "LANG": "C.UTF-8"}

def prefix():
    with open(os.path.join(BUILD, "CMakeCache.txt")) as cache:
        return re.search(r"^CMAKE_INSTALL_PREFIX:\w+=(.*)$", cache.read(), re.M).group(1)


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@unittest.skipUnless(prefix().startswith(BUILD), "the build installs outside itself, into %s" % prefix())
class InstallTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        subprocess.run(["cmake", "--install", BUILD], check=True, stdout=subprocess.DEVNULL)

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()

    def tearDown(self):
        self.folder.cleanup()

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def run_clean(self, *words, timeout=300):
        done = subprocess.run(words, env=CLEAN, cwd=self.folder.name, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, timeout=timeout)
        self.assertEqual(done.returncode, 0, done.stdout[-3000:])
        return done.stdout

    def in_ros(self, command, timeout=300):
        setup = 'set +u; . "%s/setup.bash"; export ROS_HOME="%s"; ' % (prefix(), self.path("ros_home"))
        return self.run_clean("bash", "-c", setup + command, timeout=timeout)

    def test_programs_run_without_any_environment(self):
        for program in ("match", "evaluate"):
            self.assertIn("Usage", self.run_clean(os.path.join(prefix(), "lib", "fdp_stereo", program), "--help"))

    def test_nothing_refers_to_the_build_or_the_sources(self):
        for folder, _, names in os.walk(prefix()):
            for name in names:
                if name.endswith(".pyc"):  # Python's bytecode names the file it was compiled from
                    continue
                with open(os.path.join(folder, name), "rb") as file:
                    content = file.read()
                for place in (os.path.join(BUILD, "devel"), os.path.join(SOURCE, "src"), os.path.join(SOURCE, "include")):
                    self.assertFalse(place.encode() + b"/" in content, "%s names %s" % (os.path.join(folder, name), place))

    def test_rosrun_finds_the_programs(self):
        self.assertIn("Usage", self.in_ros("rosrun fdp_stereo match --help"))

    def test_the_demo_runs(self):
        port = free_port()
        said = self.in_ros("export ROS_MASTER_URI=http://localhost:%d; timeout 200 roslaunch -p %d fdp_stereo "
                           "demo.launch output:=$PWD/out" % (port, port))
        self.assertNotIn("has died", said)
        with open(self.path("out/summary.txt")) as summary:
            self.assertRegex(summary.read(), r"disparity images out: +[1-9]")
        self.assertTrue(os.path.exists(self.path("out/output.bag")))


if __name__ == "__main__":
    unittest.main()
