#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""range: what a camera sees, and one clear line for numbers that are none."""
import os
import unittest

from support import BIN, run


@unittest.skipUnless(os.path.exists(os.path.join(BIN, "range")), "built without ROS")
class RangeTest(unittest.TestCase):
    def test_distances_errors_and_the_wanted_range(self):
        code, out, err = run("range", "--focal", 500, "--baseline", 0.1, "--disparity-range", 128, "--nearest", 0.3)
        self.assertEqual(code, 0, err)
        self.assertIn("sees from 0.394 m", out)  # 500 * 0.1 / 127
        self.assertIn("0.005 m at 1 m, 0.02 m at 2 m", out)  # z^2 * 0.25 / 50
        self.assertIn("disparity_range 176", out)  # 166.7 px, in steps of 16

    def test_refuses_what_is_no_number(self):
        for option, value in (("--focal", "nan"), ("--baseline", "NaN"), ("--sigma", "-nan"), ("--nearest", "inf"),
                              ("--focal", 0)):
            arguments = {"--focal": 500, "--baseline": 0.1, option: value}
            with self.subTest(option=option, value=value):
                code, out, err = run("range", *["%s=%s" % pair for pair in arguments.items()])
                self.assertEqual((code, out), (2, ""))
                self.assertRegex(err, "^range: %s: Value .*\n$" % option)


if __name__ == "__main__":
    unittest.main()
