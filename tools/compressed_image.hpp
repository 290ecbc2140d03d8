// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

namespace fdp_stereo {

/// The image in a message of compressed_image_transport, as its subscriber would give it. Throws std::runtime_error
/// naming `topic`; more than max_pixels are refused before anything is decoded.
sensor_msgs::ImagePtr decompress(const sensor_msgs::CompressedImage& message, const std::string& topic,
                                 std::int64_t max_pixels);

}  // namespace fdp_stereo
