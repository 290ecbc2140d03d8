// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include <opencv2/core.hpp>

namespace fdp_stereo {

/// Bytes at the beginning of a file that tell its format.
constexpr std::size_t kImageMagicBytes = 12;

/// Throws std::runtime_error naming the image unless its first bytes are those of a format with a decoder that stands
/// any content: OpenCV knows others by their content, and one of them ends the process.
void checkImageFormat(std::string_view bytes, const std::string& name);

/// The size that an image of such a format claims, found without decoding it. Throws where it is truncated, or claims
/// more than kMaxImageSide or than its bytes can hold: decoders allocate before they find out.
cv::Size claimedImageSize(std::string_view bytes, const std::string& name);

}  // namespace fdp_stereo
