#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""process_bag on recordings that are whole, compressed, cut off, and incomplete."""
import os
import tempfile
import unittest

import cv2
import numpy as np

from support import BIN, read_pfm, rendered_pair, run

PRESENT = os.path.exists(os.path.join(BIN, "process_bag"))
if PRESENT:
    import genpy
    import rosbag
    from sensor_msgs.msg import CameraInfo, CompressedImage, Image
    from std_msgs.msg import String

FOCAL, BASELINE, CX_LEFT, CX_RIGHT = 200.0, 0.1, 55.0, 58.0


def header(message, stamp):
    message.header.stamp = genpy.Time(stamp)
    message.header.frame_id = "left_optical"
    return message


def image_message(image, stamp):
    message = header(Image(), stamp)
    message.height, message.width, message.encoding = image.shape[0], image.shape[1], "bgr8"
    message.step, message.data = 3 * image.shape[1], image.tobytes()
    return message


def compressed_message(image, stamp):
    message = header(CompressedImage(), stamp)
    message.format, message.data = "bgr8; png compressed bgr8", cv2.imencode(".png", image)[1].tobytes()
    return message


def camera_info(shape, cx, tx, stamp, distortion=0.0):
    message = header(CameraInfo(), stamp)
    message.height, message.width, message.distortion_model = shape[0], shape[1], "plumb_bob"
    message.D = [distortion, 0, 0, 0, 0]
    message.K = [FOCAL, 0, cx, 0, FOCAL, 30, 0, 0, 1]
    message.R = [1, 0, 0, 0, 1, 0, 0, 0, 1]
    message.P = [FOCAL, 0, cx, tx, 0, FOCAL, 30, 0, 0, 0, 1, 0]
    return message


@unittest.skipUnless(PRESENT, "built without ROS")
class ProcessBagTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.left, self.right, _ = rendered_pair()
        self.input, self.output = self.path("in.bag"), self.path("out.bag")

    def tearDown(self):
        self.folder.cleanup()

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def write_bag(self, frames=3, compressed=False, infos=("left", "right"), distortion=0.0, name="image_rect"):
        with rosbag.Bag(self.input, "w") as bag:
            for i in range(frames):
                stamp = 10.0 + 0.1 * i
                for side, image, cx, tx in (("left", self.left, CX_LEFT, 0.0),
                                            ("right", self.right, CX_RIGHT, -FOCAL * BASELINE)):
                    topic = "/stereo/%s/%s" % (side, name)
                    if compressed:
                        bag.write(topic + "/compressed", compressed_message(image, stamp), genpy.Time(stamp))
                    else:
                        bag.write(topic, image_message(image, stamp), genpy.Time(stamp))
                    if side in infos:
                        bag.write("/stereo/%s/camera_info" % side,
                                  camera_info(image.shape, cx, tx, stamp, distortion), genpy.Time(stamp))
            bag.write("/chatter", String(data="other"), genpy.Time(10.05))

    def process(self, *options, code=0):
        actual, out, err = run("process_bag", self.input, self.output, "--num-disparities", 16, "--set",
                               "row_alignment.mode=per_frame", *options)
        self.assertEqual(actual, code, err)
        return out, err

    def messages(self, topic):
        with rosbag.Bag(self.output) as bag:
            return [message for _, message, _ in bag.read_messages(topics=[topic])]

    def expected_disparity(self):
        """What match says, in published units: NaN where there is no answer or the match is outside the right image."""
        cv2.imwrite(self.path("left.png"), self.left)
        cv2.imwrite(self.path("right.png"), self.right)
        code, _, err = run("match", self.path("left.png"), self.path("right.png"), "-o", self.path("d.pfm"),
                           "--num-disparities", 16)
        self.assertEqual(code, 0, err)
        disparity = read_pfm(self.path("d.pfm"))
        seen = np.isfinite(disparity) & (np.arange(disparity.shape[1]) - disparity >= 0)
        return np.where(seen, disparity - np.float32(CX_LEFT - CX_RIGHT), np.nan)

    def check_disparities(self, frames):
        expected = self.expected_disparity()
        found = self.messages("/stereo/disparity")
        self.assertEqual(len(found), frames)
        for message in found:
            published = np.frombuffer(message.image.data, np.float32).reshape(expected.shape)
            known = published >= message.min_disparity
            np.testing.assert_array_equal(known, np.isfinite(expected))
            np.testing.assert_array_equal(published[known], expected[known].astype(np.float32))
            self.assertAlmostEqual(message.T, BASELINE, places=6)

    def test_gives_a_disparity_per_pair_equal_to_the_core(self):
        self.write_bag()
        out, _ = self.process()
        self.assertIn("3 disparity images, 0 pairs refused, 0 stamps", out)
        self.check_disparities(3)
        depth = np.frombuffer(self.messages("/stereo/depth")[0].data, np.float32)
        expected = FOCAL * BASELINE / self.expected_disparity().ravel()
        np.testing.assert_allclose(depth, expected, rtol=1e-5)
        self.assertEqual(len(self.messages("/stereo/confidence")), 3)
        self.assertEqual(len(self.messages("/stereo/depth/camera_info")), 3)

    def test_copies_what_was_there(self):
        self.write_bag()
        self.process()
        self.assertEqual([message.data for message in self.messages("/chatter")], ["other"])
        self.assertEqual(self.messages("/stereo/left/image_rect")[2].data, self.left.tobytes())

    def test_reads_compressed_images(self):
        self.write_bag(frames=2, compressed=True)
        self.process()
        self.check_disparities(2)

    def test_reads_other_names(self):
        self.write_bag(frames=1, name="image_raw")
        self.process("--image-name", "image_raw")
        self.check_disparities(1)

    def test_a_recording_that_was_cut_off(self):
        self.write_bag()
        with open(self.input, "r+b") as file:
            file.truncate(os.path.getsize(self.input) * 2 // 3)
        _, err = self.process(code=1)
        self.assertEqual(err.count("\n"), 1, err)
        self.assertIn("in.bag", err)
        self.assertFalse(os.path.exists(self.output))

    def test_a_missing_calibration_is_named_beside_what_there_is(self):
        self.write_bag(infos=("left",))
        _, err = self.process(code=1)
        self.assertIn("no messages on /stereo/right/camera_info", err)
        self.assertIn("/chatter (std_msgs/String)", err)

    def test_images_that_are_not_rectified_are_refused(self):
        self.write_bag(name="image_raw", distortion=-0.2)
        _, err = self.process("--image-name", "image_raw", code=1)
        self.assertIn("rectify", err)
        self.assertFalse(os.path.exists(self.output), "nothing that looks finished")

    def test_an_existing_output_is_kept_unless_told_otherwise(self):
        self.write_bag(frames=1)
        self.process()
        _, err = self.process(code=1)
        self.assertIn("exists already", err)
        self.process("--overwrite")

    def test_wrong_usage_and_missing_files(self):
        code, _, err = run("process_bag", self.input)
        self.assertEqual((code, err.count("\n")), (2, 1))
        _, err = self.process(code=1)
        self.assertIn("no such file", err)
        with open(self.input, "w") as file:
            file.write("no bag at all")
        _, err = self.process(code=1)
        self.assertIn("in.bag", err)


if __name__ == "__main__":
    unittest.main()
