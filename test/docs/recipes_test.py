#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""Recipes whose packages are not here: roslaunch reads them, and the topics that they join have the same type."""
import glob
import os
import re
import subprocess
import unittest
import xml.etree.ElementTree as ElementTree

ROOT = os.environ["FDP_STEREO_SOURCE"]
BUILD = os.environ["FDP_STEREO_BUILD"]
RECIPES = sorted(glob.glob(os.path.join(ROOT, "launch", "recipes", "*.launch")))

# What the nodes subscribe to and which parameters they have, from their documentation on wiki.ros.org.
INTERFACES = {
    "octomap_server_node": ({"cloud_in": "PointCloud2"}, {"frame_id", "resolution", "sensor_model/max_range"}),
    "depthimage_to_laserscan": ({"image": "Image", "camera_info": "CameraInfo"},
                                {"scan_height", "range_min", "range_max", "output_frame_id"}),
    "rgbd_odometry": ({"rgb/image": "Image", "rgb/camera_info": "CameraInfo", "depth/image": "Image"},
                      {"frame_id", "approx_sync"}),
    "rtabmap": ({"rgb/image": "Image", "rgb/camera_info": "CameraInfo", "depth/image": "Image"},
                {"frame_id", "approx_sync", "subscribe_depth"}),
    "usb_cam_node": ({}, {"video_device", "camera_name", "camera_frame_id", "camera_info_url", "pixel_format"}),
    "nodelet": ({}, {"enable_infra1", "enable_infra2", "enable_color", "enable_depth", "infra_width", "infra_height",
                     "infra_fps"}),
    "costmap_2d_node": ({}, set()),
}


def topics():
    """Type of each topic, from the tables of docs/nodes.md."""
    with open(os.path.join(ROOT, "docs", "nodes.md")) as file:
        rows = re.findall(r"^\| (`[^|]+) \| ([^|]+) \|", file.read(), flags=re.M)
    found = {}
    for names, types in rows:
        names = re.findall(r"`([\w/]+)`", names)
        types = re.findall(r"(?:\w+/)?([A-Z]\w+)", types)
        for i, name in enumerate(names):
            if types:
                found[name] = types[-1] if name.endswith(("camera_info", "scan")) else types[0]
    return found


class RecipesTest(unittest.TestCase):
    def setUp(self):
        self.topics = topics()
        self.assertEqual(self.topics["scan"], "LaserScan")
        self.assertEqual(self.topics["depth/camera_info"], "CameraInfo")

    def ours(self, name):
        return self.topics.get(name.replace("$(arg camera)/", "").strip("/"))

    def test_roslaunch_reads_them(self):
        for recipe in RECIPES:
            with self.subTest(recipe=os.path.basename(recipe)):
                command = ". %s/devel/setup.sh && roslaunch --nodes %s calibration:=/tmp" % (BUILD, recipe)
                done = subprocess.run(["sh", "-c", command], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                      stderr=subprocess.PIPE, text=True)
                self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_joined_topics_have_the_same_type(self):
        for recipe in RECIPES:
            for node in ElementTree.parse(recipe).iter("node"):
                if node.get("pkg") in ("rosbag", "topic_tools", "image_transport") or "manager" in node.get("name"):
                    continue
                types, parameters = INTERFACES[node.get("type")]
                with self.subTest(recipe=os.path.basename(recipe), node=node.get("name")):
                    self.assertLessEqual({p.get("name") for p in node.iter("param")}, parameters)
                    remaps = {r.get("from"): r.get("to") for r in node.iter("remap")}
                    self.assertEqual(set(remaps), set(types), "every input is joined")
                    for inside, outside in remaps.items():
                        self.assertEqual(self.ours(outside), types[inside], outside)

    def test_costmaps_take_what_is_published(self):
        count = 0
        for recipe in RECIPES:
            with open(recipe) as file:
                text = file.read()
            for topic, kind in re.findall(r"topic: (/\$\(arg camera\)/\w+),?\s+data_type: (\w+)", text):
                count += 1
                self.assertEqual(self.ours(topic), kind, topic)
        self.assertEqual(count, 3)

    def test_the_page_has_all_of_them(self):
        with open(os.path.join(ROOT, "docs", "recipes.md")) as file:
            page = file.read()
        for recipe in RECIPES:
            self.assertIn("../launch/recipes/" + os.path.basename(recipe), page)


if __name__ == "__main__":
    unittest.main()
