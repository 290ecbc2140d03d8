#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""images_to_bag: order, stamps, calibrations that do not fit, and what is left where something is wrong."""
import os
import tempfile
import unittest

import cv2
import numpy as np

from support import BIN, run

PRESENT = os.path.exists(os.path.join(BIN, "images_to_bag"))
if PRESENT:
    import rosbag

SIZE = (48, 64)  # height, width
KEYS = ("image_width", "image_height", "camera_matrix", "distortion_model", "distortion_coefficients",
        "rectification_matrix", "projection_matrix")


def calibration(tx, width=64, height=48, without=None):
    lines = {"image_width": str(width), "image_height": str(height), "distortion_model": "plumb_bob",
             "camera_matrix": "{rows: 3, cols: 3, data: [500, 0, 32, 0, 500, 24, 0, 0, 1]}",
             "distortion_coefficients": "{rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}",
             "rectification_matrix": "{rows: 3, cols: 3, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}",
             "projection_matrix": "{rows: 3, cols: 4, data: [500, 0, 32, %g, 0, 500, 24, 0, 0, 0, 1, 0]}" % tx}
    return "".join("%s: %s\n" % item for item in lines.items() if item[0] != without)


@unittest.skipUnless(PRESENT, "built without ROS")
class ImagesToBagTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.bag = self.path("out.bag")
        self.write("left.yaml", calibration(0))
        self.write("right.yaml", calibration(-50))
        for side in ("left", "right"):
            os.makedirs(self.path(side))
            for value in (1, 2, 10):
                self.picture("%s/%d.png" % (side, value), value)

    def tearDown(self):
        self.folder.cleanup()

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def write(self, name, text):
        with open(self.path(name), "w") as file:
            file.write(text)
        return self.path(name)

    def picture(self, name, value, size=SIZE):
        self.assertTrue(cv2.imwrite(self.path(name), np.full(size, value, np.uint8)))

    def make(self, *options, left="left", right="right", left_info="left.yaml", right_info="right.yaml", code=0):
        actual, out, err = run("images_to_bag", "--left", self.path(left), "--right", self.path(right), "--left-info",
                               self.path(left_info), "--right-info", self.path(right_info), "--output", self.bag, *options)
        self.assertEqual(actual, code, err)
        if code != 0:
            self.assertEqual((err.count("\n"), err[:15]), (1, "images_to_bag: "), err)
            self.assertNotIn("out.bag", os.listdir(self.folder.name))
            self.assertNotIn("out.bag.partial", os.listdir(self.folder.name))
        return out + err

    def messages(self, topic="/stereo/left/image_raw"):
        with rosbag.Bag(self.bag) as bag:
            return [message for _, message, _ in bag.read_messages(topics=[topic])]

    def test_images_in_the_order_of_their_numbers(self):
        for name in (".hidden.png", "Thumbs.db", ".DS_Store", "notes.txt"):
            self.write("left/" + name, "no image")
        self.make()
        self.assertEqual([message.data[0] for message in self.messages()], [1, 2, 10])
        for side in ("left", "right"):
            for name, value in (("1.png", "frame0009.png"), ("2.png", "frame010.png"), ("10.png", "frame10a.png")):
                os.rename(self.path(side + "/" + name), self.path(side + "/" + value))
        self.make("--overwrite")
        self.assertEqual([message.data[0] for message in self.messages()], [1, 2, 10])

    def test_an_existing_file_is_kept(self):
        self.write("out.bag", "mine")
        code, _, err = run("images_to_bag", "--left", self.path("left"), "--right", self.path("right"), "--left-info",
                           self.path("left.yaml"), "--right-info", self.path("right.yaml"), "--output", self.bag)
        self.assertEqual(code, 1)
        self.assertIn("exists already", err)
        with open(self.bag) as file:
            self.assertEqual(file.read(), "mine")
        self.write("right/2.png", "broken")
        code, _, err = run("images_to_bag", "--left", self.path("left"), "--right", self.path("right"), "--left-info",
                           self.path("left.yaml"), "--right-info", self.path("right.yaml"), "--output", self.bag, "--overwrite")
        self.assertEqual(code, 1)
        self.assertIn("2.png", err)
        with open(self.bag) as file:
            self.assertEqual(file.read(), "mine")
        for name in ("left/1.png", "left.yaml"):
            self.bag = self.path(name)
            actual, _, err = run("images_to_bag", "--left", self.path("left"), "--right", self.path("right"), "--left-info",
                                 self.path("left.yaml"), "--right-info", self.path("right.yaml"), "--output", self.bag,
                                 "--overwrite")
            self.assertEqual(actual, 1)
            self.assertIn("is an input", err)

    def test_calibrations_that_do_not_fit(self):
        self.assertIn("swapped", self.make(left_info="right.yaml", right_info="left.yaml", code=1))
        self.assertIn("given for both cameras", self.make(right_info="left.yaml", code=1))
        self.write("copy.yaml", calibration(0))
        self.assertIn("baseline", self.make(right_info="copy.yaml", code=1))
        self.write("large.yaml", calibration(-50, 128, 96))
        self.assertIn("large.yaml", self.make(right_info="large.yaml", code=1))
        for width, text in ((-64, "-64"), ("741.5", "741.5"), ("wide", "wide"), (0, "0"), ("[1]", "no number")):
            self.write("odd.yaml", calibration(0, width))
            self.assertIn("image_width is %s, must be a whole number" % text, self.make(left_info="odd.yaml", code=1))
        for key in KEYS:
            self.write("lacks.yaml", calibration(0, without=key))
            self.assertIn("lacks " + key, self.make(left_info="lacks.yaml", code=1))

    def test_files_of_other_kinds_are_named(self):
        kinds = {"FileStorage": "%YAML:1.0\n---\nM: !!opencv-matrix\n   rows: 3\n", ".ini": "# oST version 5.0 parameters\n",
                 "FileStorage.": "<?xml version=\"1.0\"?>\n<opencv_storage>\n", "holds no keys": "- 1\n- 2\n"}
        for kind, text in kinds.items():
            self.write("other.yaml", text)
            err = self.make(left_info="other.yaml", code=1)
            self.assertIn(kind.rstrip("."), err)
            self.assertIn("wanted is the YAML of camera_calibration", err)
        self.write("other.yaml", "")
        self.assertIn("holds no keys", self.make(left_info="other.yaml", code=1))
        self.write("other.yaml", "a: [1,\n")
        self.assertIn("line 2", self.make(left_info="other.yaml", code=1))

    def test_pictures_of_another_size(self):
        self.picture("right/2.png", 2, (24, 32))
        self.assertIn("2.png: is 32 x 24 px, its calibration is for 64 x 48", self.make(code=1))
        os.remove(self.path("right/2.png"))
        self.assertIn("3 left images but 2 right", self.make(code=1))

    def stamps(self, text, code=0):
        self.write("stamps.txt", text)
        return self.make("--timestamps", self.path("stamps.txt"), "--overwrite", code=code)

    def test_stamps_in_ns_and_seconds(self):
        for text in ("1500000000\n2000000000\n3000000000\n", "1.5\n2.0\n3.000\n", "# ns\n1500000000\r\n\n2.\n 3.0 \n",
                     "#timestamp [ns],filename\n1500000000,1.png\n2000000000,2.png\n3000000000,10.png\n",
                     "3000000000,10.png\n1500000000,1.png\n1700000000,5.png\n2000000000,2.png\n"):
            self.stamps(text)
            self.assertEqual([message.header.stamp.to_nsec() for message in self.messages()],
                             [1500000000, 2000000000, 3000000000])
        self.stamps("1403715277.012143104\n1403715277.062142976\n1403715278.0\n")
        self.assertEqual(self.messages()[0].header.stamp.to_nsec(), 1403715277012143104)

    def test_stamps_that_cannot_be(self):
        for text, part in (("1\n2\n3\n", "1 ns after"), ("3.0\n2.0\n1.0\n", "must rise"), ("1.0\n1.0\n2.0\n", "must rise"),
                           ("0\n1.0\n2.0\n", ":1: 0 is no time"), ("1.0\n2.0\n", "2 stamps for 3 pairs"),
                           ("1.0\n2.0\n3.0\n4.0\n", "4 stamps for 3 pairs"), ("1.0\nnow\n3.0\n", ":2: 'now' is no stamp"),
                           ("1.0.0\n2.0\n3.0\n", ":1: '1.0.0' is no stamp"), ("-1\n2.0\n3.0\n", "'-1' is no stamp"),
                           ("99999999999.0\n2.0\n3.0\n", "is no time"), ("1e9\n2.0\n3.0\n", "'1e9' is no stamp"),
                           ("1.0,1.png\n2.0,2.png\n3.0,3.png\n", "has no stamp for"), ("\n", "0 stamps for 3 pairs")):
            self.assertIn(part, self.stamps(text, code=1))


if __name__ == "__main__":
    unittest.main()
