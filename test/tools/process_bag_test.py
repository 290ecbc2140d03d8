#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""process_bag on recordings that are whole, compressed, cut off, and incomplete."""
import os
import re
import signal
import subprocess
import tempfile
import time
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


def write_calibration(path, info):
    def matrix(name, rows, values):
        return "%s: {rows: %d, cols: %d, data: %s}\n" % (name, rows, len(values) // rows, [float(v) for v in values])
    with open(path, "w") as file:
        file.write("image_width: %d\nimage_height: %d\ncamera_name: camera\ndistortion_model: plumb_bob\n" %
                   (info.width, info.height))
        file.write(matrix("camera_matrix", 3, info.K) + matrix("distortion_coefficients", 1, info.D) +
                   matrix("rectification_matrix", 3, info.R) + matrix("projection_matrix", 3, info.P))


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

    def expected_disparity(self, depth=np.uint8, options=()):
        """What match says, in published units: NaN where there is no answer or the match is outside the right image."""
        cv2.imwrite(self.path("left.png"), self.left.astype(depth))
        cv2.imwrite(self.path("right.png"), self.right.astype(depth))
        code, _, err = run("match", self.path("left.png"), self.path("right.png"), "-o", self.path("d.pfm"),
                           "--num-disparities", 16, "--overwrite", *options)
        self.assertEqual(code, 0, err)
        disparity = read_pfm(self.path("d.pfm"))
        return np.where(np.isfinite(disparity), disparity - np.float32(CX_LEFT - CX_RIGHT), np.nan)

    def check_disparities(self, frames, depth=np.uint8, options=()):
        expected = self.expected_disparity(depth, options)
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
        self.assertIn("3 disparity images, 0 pairs refused, 0 images", out)
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
        for name in ("image_raw", "image_color", "image_mono"):
            self.write_bag(name=name, distortion=-0.2)
            _, err = self.process("--image-name", name, code=1)
            self.assertIn("use --rectify", err)
            self.assertEqual(os.listdir(self.folder.name), ["in.bag"], "nothing that looks finished")
        self.process("--image-name", "image_mono", "--rectified")
        self.check_disparities(3)

    def test_images_that_are_rectified_by_name_or_calibration_are_taken(self):
        for name, distortion in (("image_rect", -0.2), ("image_rect_color", -0.2), ("image_raw", 0.0)):
            self.write_bag(frames=1, name=name, distortion=distortion)
            self.process("--image-name", name, "--overwrite")
            self.check_disparities(1)

    def test_an_existing_output_is_kept_unless_told_otherwise(self):
        self.write_bag(frames=1)
        self.process()
        _, err = self.process(code=1)
        self.assertIn("exists already", err)
        code, _, err = run("process_bag", self.input, self.input, "--overwrite")
        self.assertEqual(code, 1)
        self.assertIn("is an input", err)
        code, _, err = run("process_bag", self.input, "/does/not/exist/out.bag")
        self.assertIn("there is no folder", err)
        self.process("--overwrite")

    def write_messages(self, packed=None, change=None, frames=2, late=0.0, raw_too=False, info_every=1):
        """Pairs whose messages `packed(frame, side, image)` compresses and `change(frame, side, info)` edits."""
        with rosbag.Bag(self.input, "w") as bag:
            for i in range(frames):
                for side, image, cx, tx in (("left", self.left, CX_LEFT, 0.0),
                                            ("right", self.right, CX_RIGHT, -FOCAL * BASELINE)):
                    stamp = 10.0 + i + (late if side == "right" else 0.0)
                    topic, time = "/stereo/" + side, genpy.Time(10.0 + i)
                    if packed is None or raw_too:
                        bag.write(topic + "/image_rect", image_message(image, stamp), time)
                    if packed is not None:
                        message = header(CompressedImage(), stamp)
                        message.format, message.data = packed(i, side, image)
                        bag.write(topic + "/image_rect/compressed", message, time)
                    if i % info_every == 0:
                        info = camera_info(image.shape, cx, tx, stamp)
                        if change:
                            change(i, side, info)
                        bag.write(topic + "/camera_info", info, time)

    def test_every_form_of_compressed_image(self):
        def encode(image, extension=".png"):
            return cv2.imencode(extension, image)[1].tobytes()
        forms = {"bgr8; png compressed bgr8": lambda image: image, "rgb8; png compressed bgr8": lambda image: image,
                 "png": lambda image: image, "bgra8; png compressed bgra8": lambda i: cv2.cvtColor(i, cv2.COLOR_BGR2BGRA),
                 "rgb8; png compressed ": lambda image: image[:, :, ::-1],
                 "bgr16; png compressed bgr16": lambda image: image.astype(np.uint16)}
        for form, convert in forms.items():
            with self.subTest(form=form):
                self.write_messages(lambda i, side, image: (form, encode(convert(image))))
                self.process("--overwrite")
                self.check_disparities(2, convert(self.left).dtype)
        self.write_messages(lambda i, side, image: ("bgr8; jpeg compressed bgr8", encode(image, ".jpg")))
        self.process("--overwrite")
        self.assertEqual(len(self.messages("/stereo/disparity")), 2)

    def test_a_compressed_bayer_pattern_is_not_grey(self):
        def mosaic(image):
            pattern = np.empty(image.shape[:2], np.uint8)
            for y, x, channel in ((0, 0, 2), (0, 1, 1), (1, 0, 1), (1, 1, 0)):
                pattern[y::2, x::2] = image[y::2, x::2, channel]
            return pattern
        with rosbag.Bag(self.input, "w") as bag:
            for side, image, cx, tx in (("left", self.left, CX_LEFT, 0.0), ("right", self.right, CX_RIGHT, -20.0)):
                packed, raw = header(CompressedImage(), 1.0), image_message(image, 2.0)
                packed.format = "bayer_rggb8; png compressed "
                packed.data = cv2.imencode(".png", mosaic(image))[1].tobytes()
                raw.encoding, raw.step, raw.data = "bayer_rggb8", image.shape[1], mosaic(image).tobytes()
                for camera, message in (("/a/", packed), ("/b/", raw)):
                    bag.write(camera + side + "/image_rect" + ("/compressed" if message is packed else ""), message)
                    info = camera_info(image.shape, cx, tx, 0.0)
                    info.header.stamp = message.header.stamp
                    bag.write(camera + side + "/camera_info", info)
        found = []
        for camera in ("a", "b"):
            self.process("--namespace", camera, "--overwrite")
            found.append(self.messages("/%s/disparity" % camera)[0].image.data)
        self.assertEqual(found[0], found[1])

    def test_one_bad_image_costs_one_pair(self):
        png = cv2.imencode(".png", self.left)[1].tobytes()
        jpeg = cv2.imencode(".jpg", self.left)[1].tobytes()
        huge = bytearray(png)
        huge[16:24] = b"\0\0\xea\x60" * 2
        bomb = bytearray(png)
        bomb[16:24] = b"\0\0\x40\x00" * 2
        bad = {"dicom": b"\xd5" * 128 + b"DICM2 V", "huge": bytes(huge), "bomb": bytes(bomb), "empty": b"",
               "random": os.urandom(1000), "cut png": png[:len(png) // 2], "cut jpeg": jpeg[:len(jpeg) // 2],
               "magic": b"\xff\xd8\xff", "gif": b"GIF89a" + bytes(100), "tiff": b"II*\0" + bytes(8)}
        for name, data in bad.items():
            with self.subTest(name=name):
                self.write_messages(lambda i, side, image: ("bgr8; png compressed bgr8",
                                    data if (i, side) == (1, "left") else cv2.imencode(".png", image)[1].tobytes()), frames=3)
                out, err = self.process("--overwrite")
                self.assertIn("2 disparity images, 1 pairs refused", out)
                self.assertIn("/stereo/left/image_rect/compressed: ", err)
                self.check_disparities(2)

    def test_raw_images_win_over_compressed_ones(self):
        noise = np.random.RandomState(0).randint(0, 256, self.left.shape).astype(np.uint8)
        self.write_messages(lambda i, side, image: ("png", cv2.imencode(".png", noise)[1].tobytes()), raw_too=True)
        out, _ = self.process()
        self.assertIn("2 disparity images, 0 pairs refused, 0 images", out)
        self.check_disparities(2)

    def test_views_are_not_mixed_of_raw_and_compressed_images(self):
        self.write_messages(lambda i, side, image: ("png", cv2.imencode(".png", image)[1].tobytes()))
        with rosbag.Bag(self.input, "a") as bag:  # raw ones of the left view alone
            bag.write("/stereo/left/image_rect", image_message(255 - self.left, 10.0), genpy.Time(20))
        self.process()
        self.check_disparities(2)

    def test_stamps_that_nearly_meet(self):
        for late in (1e-6, 0.005, 0.04):
            self.write_messages(late=late, frames=4)
            _, err = self.process("--overwrite", code=1)
            apart_ms = float(re.search(r"at best (\S+) ms apart; use --approximate-sync", err).group(1))
            self.assertAlmostEqual(apart_ms, late * 1e3, delta=2e-6 + late)
            self.assertEqual(err.count("\n"), 1, err)
            self.assertEqual([name for name in os.listdir(self.folder.name) if name.startswith("out.bag")], [])
            out, _ = self.process("--approximate-sync", "--overwrite")
            self.assertIn("4 disparity images, 0 pairs refused, 0 images", out)
            self.check_disparities(4)
            os.remove(self.output)
        _, err = self.process("--approximate-sync", "--approximate-sync-tolerance", 0.01, code=1)
        self.assertIn("40 ms apart; allow that with --approximate-sync-tolerance", err)
        self.process("--approximate-sync", "--approximate-sync-tolerance", 0.05)
        self.check_disparities(4)

    def test_a_calibration_that_was_sent_once(self):
        for options in ([], ["--approximate-sync"]):
            self.write_messages(frames=5, info_every=100)
            out, _ = self.process("--overwrite", *options)
            self.assertIn("5 disparity images, 0 pairs refused, 0 images", out)
            self.check_disparities(5)

    def test_a_calibration_of_files(self):
        self.write_messages(change=lambda i, side, info: setattr(info, "P", [0.0] * 12))
        self.process(code=1)
        for side, cx, tx in (("left", CX_LEFT, 0.0), ("right", CX_RIGHT, -FOCAL * BASELINE)):
            write_calibration(self.path(side + ".yaml"), camera_info(self.left.shape, cx, tx, 0.0))
        self.process("--left-calibration", self.path("left.yaml"), "--right-calibration", self.path("right.yaml"))
        self.check_disparities(2)
        code, _, err = run("process_bag", self.input, self.output, "--left-calibration", self.path("left.yaml"))
        self.assertEqual((code, err.count("\n")), (2, 1), err)

    def test_names_in_any_spelling(self):
        self.write_messages()
        for spelling in ("stereo", "/stereo/", "//stereo", "stereo/"):
            self.process("--namespace", spelling, "--overwrite")
            self.check_disparities(2)
        with rosbag.Bag(self.input, "w") as bag:
            for side, image, tx in (("left", self.left, 0.0), ("right", self.right, -20.0)):
                bag.write("/%s/image_rect" % side, image_message(image, 1.0), genpy.Time(1))
                bag.write("%s/camera_info" % side, camera_info(image.shape, 50.0, tx, 1.0), genpy.Time(1))
        for spelling in ("", "/", "//"):
            self.process("--namespace", spelling, "--overwrite")
            self.assertEqual(len(self.messages("/disparity")), 1)

    def test_rectifies_raw_images_as_image_proc_does(self):
        turn = cv2.Rodrigues(np.array([0.01, -0.02, 0.015]))[0]
        for distortion in ((-0.2, 0.05, 0, 0, 0), (0, 0, 0, 0, 0)):
            def change(i, side, info):
                info.D = list(distortion)
                info.R = turn.ravel().tolist() if side == "left" else list(info.R)
                info.K[0] = info.K[4] = 190.0
            self.write_messages(change=change, frames=1)
            views, masks = {}, []
            with rosbag.Bag(self.input) as bag:
                for topic, message, _ in bag.read_messages():
                    if topic.endswith("camera_info"):
                        k, p = np.reshape(message.K, (3, 3)), np.reshape(message.P, (3, 4))
                        maps = cv2.initUndistortRectifyMap(k, np.array(message.D), np.reshape(message.R, (3, 3)), p[:, :3],
                                                           self.left.shape[1::-1], cv2.CV_16SC2)
                        side = topic.split("/")[2]
                        views[side] = cv2.remap(getattr(self, side), *maps, cv2.INTER_LINEAR)
                        shown = cv2.remap(np.full(self.left.shape[:2], 255, np.uint8), *maps, cv2.INTER_LINEAR)
                        cv2.imwrite(self.path(side + "_mask.png"), np.where(shown < 255, 255, 0).astype(np.uint8))
                        masks += ["--%s-mask" % side, self.path(side + "_mask.png")]
            self.process("--image-name", "image_rect", "--rectify", "--overwrite")
            self.left, self.right, kept = views["left"], views["right"], (self.left, self.right)
            self.check_disparities(1, options=masks)
            self.left, self.right = kept

    def test_masks_are_those_of_match(self):
        mask = np.zeros(self.left.shape[:2], np.uint8)
        mask[10:30, 20:60] = 255
        cv2.imwrite(self.path("mask.png"), mask)
        self.write_bag()
        masks = ["--left-mask", self.path("mask.png"), "--right-mask", self.path("mask.png")]
        self.process(*masks)
        self.check_disparities(3, options=masks)
        cv2.imwrite(self.path("mask.png"), mask[5:])
        for given in (self.path("mask.png"), "/does/not/exist.png"):
            _, err = self.process("--overwrite", "--right-mask", given, code=1)
            self.assertIn(given, err)

    def test_earlier_results_are_replaced(self):
        self.write_messages()
        self.process()
        os.replace(self.output, self.input)
        out, _ = self.process()
        self.assertIn("messages of earlier results were replaced", out)
        self.check_disparities(2)

    def test_warnings_are_told_at_the_end(self):
        def change(i, side, info):
            info.header.frame_id = side
        self.write_messages(change=change, frames=3)
        _, err = self.process()
        self.assertRegex(err, r"warning \(3 pairs\): .*frame_id 'right' differs")

    def test_an_interrupted_run_leaves_nothing(self):
        self.write_messages(frames=20)
        process = subprocess.Popen([os.path.join(BIN, "process_bag"), self.input, self.output, "--preset", "accurate",
                                    "--set", "temporal.enabled=false"], stdin=subprocess.DEVNULL)
        for _ in range(200):
            if len(os.listdir(self.folder.name)) > 1:
                break
            time.sleep(0.05)
        time.sleep(0.2)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(60), -signal.SIGINT)
        self.assertEqual(os.listdir(self.folder.name), ["in.bag"])

    def test_waiting_images_take_no_memory(self):
        """Left images whose partners come a second later, of a size that would fill 1 GB."""
        image = np.random.RandomState(1).randint(0, 256, (1080, 1920)).astype(np.uint8)
        image = cv2.GaussianBlur(image, (0, 0), 3)
        data = cv2.imencode(".jpg", image)[1].tobytes()
        with rosbag.Bag(self.input, "w") as bag:
            for i in range(300):
                for side, late in (("left", 0.0), ("right", 1e-3)):
                    message = header(CompressedImage(), 10.0 + i / 30.0 + late)
                    message.format, message.data = "mono8; jpeg compressed ", data
                    bag.write("/stereo/%s/image_rect/compressed" % side, message, genpy.Time(10.0 + i / 30.0))
                    bag.write("/stereo/%s/camera_info" % side, camera_info(image.shape, 900.0, -20.0 * (side == "right"),
                                                                           10.0 + i / 30.0 + late), genpy.Time(10.0 + i / 30.0))
        code, _, err = run("process_bag", self.input, self.output)
        self.assertEqual(code, 1)
        self.assertIn("use --approximate-sync", err)
        process = subprocess.Popen([os.path.join(BIN, "process_bag"), self.input, self.output], stdin=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL)
        peak_mb = 0.0
        while process.poll() is None:
            with open("/proc/%d/status" % process.pid) as status:
                peak_mb = max([peak_mb] + [int(line.split()[1]) / 1024.0 for line in status if line.startswith("VmHWM")])
            time.sleep(0.01)
        self.assertGreater(peak_mb, 10.0)
        self.assertLess(peak_mb, 150.0)

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
