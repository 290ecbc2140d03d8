// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Images, calibrations, masks, seeds and what points are made of: whatever they hold, an exception that says why, or a
// result.
#include <stdexcept>

#include <dynamic_reconfigure/config_tools.h>
#include <boost/make_shared.hpp>

#include "conversions.hpp"
#include "fdp_stereo/io.hpp"
#include "frame_processor.hpp"
#include "fuzz_input.hpp"
#include "point_messages.hpp"
#include "seed_conversions.hpp"

namespace fdp_stereo::fuzz {
namespace {

using dynamic_reconfigure::ConfigTools;

constexpr std::size_t kMostBytes = 8192;

void fill(std::vector<std::uint8_t>& data, std::size_t bytes, std::uint8_t seed) {
  std::uint32_t state = seed + 1U;
  while (data.size() < bytes) {
    state = state * 1664525U + 1013904223U;
    data.push_back(static_cast<std::uint8_t>(state >> 24));
  }
}

sensor_msgs::Image takeImage(Input& input) {
  static const char* const kEncodings[] = {"mono8",        "mono16", "bgr8",  "rgba8", "bayer_rggb8",
                                           "bayer_grbg16", "yuv422", "32FC1", "16UC1", "8UC3"};
  sensor_msgs::Image image;
  const auto which = input.take<std::uint8_t>();
  image.encoding = which < std::size(kEncodings) * 20 ? kEncodings[which / 20] : input.takeText(30);
  image.width = input.takeSize();
  image.height = input.takeSize();
  image.step = which % 2 == 0 ? image.width * 4 : input.takeSize();
  image.is_bigendian = input.take<std::uint8_t>();
  const std::size_t bytes = std::min<std::size_t>(kMostBytes, std::size_t{image.step} * image.height);
  image.data = input.takeBytes(bytes);
  // A few bytes make a whole texture, so that the stages behind the checks are reached.
  if (input.take<std::uint8_t>() % 4 != 0) fill(image.data, bytes, input.take<std::uint8_t>());
  return image;
}

sensor_msgs::CameraInfo takeInfo(Input& input, std::uint32_t width, std::uint32_t height) {
  sensor_msgs::CameraInfo info;
  const auto kind = input.take<std::uint8_t>();
  info.width = kind % 2 == 0 ? width : input.takeSize();
  info.height = kind % 2 == 0 ? height : input.takeSize();
  info.P = {20.0, 0.0, 8.0, -2.0, 0.0, 20.0, 8.0, 0.0, 0.0, 0.0, 1.0, 0.0};
  for (int i = 0; i < kind % 4; ++i) info.P[input.take<std::uint8_t>() % info.P.size()] = input.take<double>();
  if (kind % 8 == 7) {
    info.binning_x = input.takeSize();
    info.binning_y = input.takeSize();
    info.roi.x_offset = input.takeSize();
    info.roi.width = input.takeSize();
    info.roi.height = input.takeSize();
  }
  return info;
}

sensor_msgs::PointCloud2 takeCloud(Input& input) {
  sensor_msgs::PointCloud2 cloud;
  for (const char* name : {"x", "y", "z"}) {
    sensor_msgs::PointField field;
    field.name = name;
    field.offset = input.takeSize();
    field.datatype = input.take<std::uint8_t>();
    if (field.datatype < 230) field.datatype = sensor_msgs::PointField::FLOAT32;
    cloud.fields.push_back(field);
  }
  cloud.width = input.takeSize();
  cloud.height = input.takeSize();
  cloud.point_step = input.takeSize();
  cloud.row_step = input.takeSize();
  cloud.data = input.takeBytes(kMostBytes);
  return cloud;
}

template <typename Call>
void expectOnlyInvalid(Call&& call) {
  try {
    call();
  } catch (const std::invalid_argument&) {
  }
}

/// Sets a few parameters as the input wills.
void editSettings(Input& input, int count, NodeSettings& settings) {
  dynamic_reconfigure::Config edits;
  const auto refs = liveParamList(settings);
  for (int i = 0; i < count; ++i) {
    const ParamRef& ref = refs[input.take<std::uint8_t>() % refs.size()];
    const double share = input.take<std::uint8_t>() / 255.0;
    ConfigTools::appendParameter(edits, ref.ros_name, ref.min + share * (ref.max - ref.min));
  }
  std::vector<std::string> messages;
  settings = applyConfig(edits, settings, messages);
}

/// A valid set of parameters.
NodeSettings takeSettings(Input& input) {
  static const std::vector<PipelineParams> presets = [] {
    std::vector<PipelineParams> loaded(12, loadPreset(kDefaultPreset));  // the others take longer: now and then
    for (const std::string& name : presetNames()) loaded.push_back(loadPreset(name));
    return loaded;
  }();
  NodeSettings settings;
  const auto which = input.take<std::uint8_t>();
  settings.pipeline = presets[which / 8 % presets.size()];
  if (which % 8 < 3) editSettings(input, 1 + which % 8, settings);
  settings.pipeline.search = {static_cast<int>(input.take<std::int8_t>()), 1 + input.take<std::uint8_t>() % 16};
  settings.pipeline.threads = 1;
  settings.pipeline.local_expansion.iterations = std::min(settings.pipeline.local_expansion.iterations, 1);
  if (settings.pipeline.feature_matching.detector == FeatureDetector::kSift) {  // slow, and not this package's
    settings.pipeline.feature_matching.detector = FeatureDetector::kFastCensus;
  }
  return settings;
}

/// What rectification reads of a calibration.
void takeRawCalibration(Input& input, sensor_msgs::CameraInfo& info) {
  static const char* const kModels[] = {"plumb_bob", "rational_polynomial", "equidistant", ""};
  const auto kind = input.take<std::uint8_t>();
  info.distortion_model = kModels[kind % 4];
  for (int i = 0; i < kind / 4 % 16; ++i) info.D.push_back(0.01 * input.take<std::int8_t>());
  info.K = {18.0, 0.0, 8.0, 0.0, 19.0, 8.0, 0.0, 0.0, 1.0};
  info.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  for (int i = 0; i < kind / 64; ++i) {
    const auto place = input.take<std::uint8_t>();
    (place % 2 == 0 ? info.K : info.R)[place / 2 % 9] = input.take<double>();
  }
}

void fuzzPair(Input& input) {
  sensor_msgs::Image left = takeImage(input);
  sensor_msgs::Image right = input.take<std::uint8_t>() < 200 ? left : takeImage(input);
  StereoFrame frame;
  sensor_msgs::CameraInfo left_info = takeInfo(input, left.width, left.height);
  sensor_msgs::CameraInfo right_info = takeInfo(input, left.width, left.height);
  frame.left = boost::make_shared<sensor_msgs::Image>(left);
  frame.right = boost::make_shared<sensor_msgs::Image>(right);
  const NodeSettings settings = takeSettings(input);
  const bool raw = input.take<std::uint8_t>() % 2 != 0;
  if (raw) takeRawCalibration(input, left_info);
  if (raw) takeRawCalibration(input, right_info);
  frame.left_info = boost::make_shared<sensor_msgs::CameraInfo>(left_info);
  frame.right_info = boost::make_shared<sensor_msgs::CameraInfo>(right_info);
  const bool masked = input.take<std::uint8_t>() % 2 != 0;
  const sensor_msgs::Image mask = masked ? takeImage(input) : sensor_msgs::Image();
  const auto masks = [&](cv::Size) { return MaskPair{toMask(decodeImage(mask, "mask")), {}}; };
  FrameProcessor processor({}, nullptr, masked ? MaskProvider(masks) : nullptr,
                           raw ? InputImages::kRaw : InputImages::kRectified);
  expectOnlyInvalid([&] { processor.process(frame, settings, {true, true, true, true, true, true, true}); });
}

void fuzzSeeds(Input& input) {
  const PinholeCamera left{20.0, 20.0, 8.0, 8.0, cv::Size(16, 16)};
  const StereoGeometry geometry{20.0, 0.1, input.take<float>()};
  const auto project = [&](const Points& points) { projectSeeds(points, left, geometry, {}, SeedSource::kPoints); };
  expectOnlyInvalid([&] { project(pointsOfCloud(takeCloud(input), "cloud")); });
  const sensor_msgs::Image image = takeImage(input);
  expectOnlyInvalid([&] { project(pointsOfDepth(image, takeInfo(input, image.width, image.height), 1, "depth")); });
  stereo_msgs::DisparityImage disparity;
  disparity.image = image;
  disparity.f = input.take<float>();
  disparity.T = input.take<float>();
  disparity.min_disparity = input.take<float>();
  disparity.max_disparity = input.take<float>();
  expectOnlyInvalid([&] { project(pointsOfDisparity(disparity, left, 1, "disparity")); });
}

stereo_msgs::DisparityImage takeDisparity(Input& input) {
  stereo_msgs::DisparityImage disparity;
  disparity.image = takeImage(input);
  disparity.f = input.take<float>();
  disparity.T = input.take<float>();
  disparity.min_disparity = input.take<float>();
  disparity.max_disparity = input.take<float>();
  return disparity;
}

void fuzzPoints(Input& input) {
  const auto optional = [&](bool given) {
    return given ? boost::make_shared<sensor_msgs::Image>(takeImage(input)) : sensor_msgs::ImagePtr();
  };
  const auto parts = input.take<std::uint8_t>();
  const auto disparity = boost::make_shared<stereo_msgs::DisparityImage>(takeDisparity(input));
  const auto info =
      boost::make_shared<sensor_msgs::CameraInfo>(takeInfo(input, disparity->image.width, disparity->image.height));
  const PointFrame frame{disparity, info, optional(parts % 2 != 0), optional(parts % 4 > 1), optional(parts % 8 > 3)};
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
  place.linear() = Eigen::AngleAxisd(parts, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  place.translation().setConstant(0.01 * input.take<std::int8_t>());
  expectOnlyInvalid([&] {
    std::vector<std::string> warnings;
    const PointView view = decodePointFrame(frame, {1, 0.5, 0.1}, {}, warnings);
    toPointCloud(view, 1 + parts / 64);
    const cv::Mat free_depth = freeDepth(view);
    toFreeSpaceCloud(view, free_depth);
    toLaserScan(view, free_depth, place, "base_link", {});
  });
}

}  // namespace
}  // namespace fdp_stereo::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fdp_stereo::fuzz::Input input(data, size);
  const auto kind = input.take<std::uint8_t>();
  if (kind % 2 == 0) {
    fdp_stereo::fuzz::fuzzPair(input);
  } else if (kind > 223) {
    fdp_stereo::fuzz::fuzzPoints(input);
  } else {
    fdp_stereo::fuzz::fuzzSeeds(input);
  }
  return 0;
}
