#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""Records docs/images/live.webp, 20 seconds of the node at work: the sample as a stream with noise, parameters that are
changed while it runs, and the steadiness of what stands still. No screen is needed.

    scripts/record_animation.py [--output FILE]

Starts stereo.launch with a master of its own. Needs a build (scripts/build.sh) and python3-pil.
"""
import argparse
import os
import subprocess
import sys
import tempfile
import threading
import time

import cv2
import numpy as np
from PIL import Image

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
SAMPLE = os.path.join(ROOT, "sample", "motorcycle")
PORT = 11421
FRAME_MS = 200
WIDTH = 360  # px of one picture
NOISE = 2.0  # grey levels, of the sensor
FOCAL_PX, BASELINE_M = 500.0, 0.1

# caption, name in dynamic_reconfigure, values one after the other, frames of each; "" = nothing is changed
SCENES = (
    ("roslaunch fdp_stereo stereo.launch: images in, disparity out", "", [None], 14),
    ("disparity_range, changed live", "disparity_range", [32, 48, 64], 6),
    ("uniqueness_ratio, changed live", "uniqueness_ratio", [0, 10, 25, 0], 5),
    ("hole_filling, changed live", "hole_filling_enabled", [False, True, False], 5),
    ("a camera that stands still, pair by pair", "temporal_enabled", [False], 16),
    ("the same with the memory of the stream", "temporal_enabled", [True], 20),
)


class Node:
    """stereo.launch, its inputs, and what it answers."""

    def __init__(self, work):
        import dynamic_reconfigure.client
        import rospy
        from cv_bridge import CvBridge
        from sensor_msgs.msg import CameraInfo, Image as ImageMessage
        from stereo_msgs.msg import DisparityImage
        self.rospy, self.bridge, self.CameraInfo = rospy, CvBridge(), CameraInfo
        log = open(os.path.join(work, "launch.log"), "w")
        self.launch = subprocess.Popen(
            ["roslaunch", "-p", str(PORT), "fdp_stereo", "stereo.launch", "__ns:=stereo", "rectify:=false", "points:=false",
             "disparity_range:=64"], stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        for _ in range(100):
            if subprocess.run(["rosparam", "list"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode == 0:
                break
            time.sleep(0.2)
        rospy.init_node("record_animation", disable_signals=True)
        self.images = {side: rospy.Publisher("/stereo/%s/image_rect" % side, ImageMessage, queue_size=2)
                       for side in ("left", "right")}
        self.infos = {side: rospy.Publisher("/stereo/%s/camera_info" % side, CameraInfo, queue_size=2) for side in self.images}
        self.answer, self.answered = None, threading.Event()
        rospy.Subscriber("/stereo/disparity", DisparityImage, self.take)
        self.tuning = dynamic_reconfigure.client.Client("/stereo/disparity", timeout=30)
        self.stamp = rospy.Time.now()
        while any(publisher.get_num_connections() == 0 for publisher in [*self.images.values(), *self.infos.values()]):
            time.sleep(0.1)

    def take(self, message):
        if message.header.stamp == self.stamp:
            self.answer = self.bridge.imgmsg_to_cv2(message.image).copy(), message.min_disparity
            self.answered.set()

    def pair(self, views):
        """The disparity of one pair, px, NaN = none."""
        self.stamp += self.rospy.Duration(FRAME_MS / 1e3)
        self.answered.clear()
        for side, image in views.items():
            message = self.bridge.cv2_to_imgmsg(image, "mono8")
            info = self.CameraInfo(height=image.shape[0], width=image.shape[1], distortion_model="plumb_bob")
            message.header.stamp = info.header.stamp = self.stamp
            message.header.frame_id = info.header.frame_id = "camera"
            centre = (image.shape[1] / 2.0, image.shape[0] / 2.0)
            info.K = [FOCAL_PX, 0, centre[0], 0, FOCAL_PX, centre[1], 0, 0, 1]
            info.R = [1, 0, 0, 0, 1, 0, 0, 0, 1]
            shift = -FOCAL_PX * BASELINE_M if side == "right" else 0.0
            info.P = [FOCAL_PX, 0, centre[0], shift, 0, FOCAL_PX, centre[1], 0, 0, 0, 1, 0]
            self.infos[side].publish(info)
            self.images[side].publish(message)
        if not self.answered.wait(60.0):
            sys.exit("record_animation.py: no disparity came")
        disparity, least = self.answer
        return np.where(disparity >= least, disparity, np.nan)

    def set(self, name, value):
        self.tuning.update_configuration({name: value})

    def close(self):
        self.rospy.signal_shutdown("done")
        self.launch.terminate()
        self.launch.wait(30)


def noisy(view, random):
    return np.clip(view + random.normal(0.0, NOISE, view.shape), 0, 255).astype(np.uint8)


def colour(disparity):
    scaled = np.nan_to_num(255.0 * disparity / 64.0).clip(0, 255).astype(np.uint8)
    picture = cv2.applyColorMap(scaled, cv2.COLORMAP_TURBO)
    picture[~np.isfinite(disparity)] = 0
    return picture


def panel(left, disparity, caption, note):
    height = round(left.shape[0] * WIDTH / left.shape[1])
    pictures = [cv2.resize(picture, (WIDTH, height), interpolation=cv2.INTER_AREA)
                for picture in (cv2.cvtColor(left, cv2.COLOR_GRAY2BGR), colour(disparity))]
    bar = np.full((48, 2 * WIDTH, 3), 32, np.uint8)
    for text, row, grey in ((caption, 19, 255), (note, 40, 190)):
        cv2.putText(bar, text, (8, row), cv2.FONT_HERSHEY_SIMPLEX, 0.5, (grey, grey, grey), 1, cv2.LINE_AA)
    return np.vstack([np.hstack(pictures), bar])


def blinking(before, now):
    if before is None:
        return ""
    return ", %.1f %% of the pixels blink" % (100.0 * np.mean(np.isfinite(before) != np.isfinite(now)))


def record(node):
    views = {side: cv2.imread(os.path.join(SAMPLE, side + ".png"), cv2.IMREAD_GRAYSCALE) for side in ("left", "right")}
    random = np.random.default_rng(1)
    frames = []
    for caption, name, values, count in SCENES:
        for value in values:
            if name:
                node.set(name, value)
            before = None
            for _ in range(count):
                pair = {side: noisy(view, random) for side, view in views.items()}
                disparity = node.pair(pair)
                note = "%.0f %% answered" % (100.0 * np.mean(np.isfinite(disparity))) + blinking(before, disparity)
                frames.append(panel(pair["left"], disparity, caption, ("%s = %s, " % (name, value) if name else "") + note))
                before = disparity
    return frames


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", default=os.path.join(ROOT, "docs", "images", "live.webp"))
    options = parser.parse_args()
    os.environ["ROS_MASTER_URI"] = "http://localhost:%d" % PORT
    with tempfile.TemporaryDirectory() as work:
        os.environ["ROS_HOME"] = os.environ["ROS_LOG_DIR"] = work
        node = Node(work)
        try:
            frames = record(node)
        finally:
            node.close()
    pictures = [Image.fromarray(cv2.cvtColor(frame, cv2.COLOR_BGR2RGB)) for frame in frames]
    pictures[0].save(options.output, save_all=True, append_images=pictures[1:], duration=FRAME_MS, loop=0, quality=40, method=4)
    print("%s: %d frames, %.0f s, %.2f MB" % (options.output, len(frames), len(frames) * FRAME_MS / 1e3,
                                              os.path.getsize(options.output) / 1e6))


if __name__ == "__main__":
    main()
