// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "frame_processor.hpp"

#include <cmath>
#include <functional>
#include <memory>

#include <gtest/gtest.h>

#include "messages.hpp"

namespace fdp_stereo {
namespace {

using test::goodMessages;
using test::imageMessage;
using test::kBaseline;
using test::kFocal;
using test::kPlaneDisparity;
using test::Messages;

const WantedOutputs kAll{true, true, true, true, true, true};

NodeSettings settings() {
  NodeSettings s;
  s.pipeline = loadPreset(kDefaultPreset);
  s.pipeline.search = {0, 32};
  return s;
}

cv::Mat pixels(const sensor_msgs::Image& image) {
  return cv::Mat(static_cast<int>(image.height), static_cast<int>(image.width), CV_32FC1,
                 const_cast<std::uint8_t*>(image.data.data()), image.step);
}

FrameOutput run(const Messages& messages, const NodeSettings& s = settings()) {
  FrameProcessor processor({});
  return processor.process(messages.frame(), s, kAll);
}

/// Share of the pixels that lie within 0.5 px of `disparity`.
double shareAt(const FrameOutput& output, double disparity) {
  const cv::Mat map = pixels(output.disparity->image);
  return cv::countNonZero(cv::abs(map - disparity) < 0.5) / static_cast<double>(map.total());
}

/// The core's result for the same pixels, in published units.
cv::Mat coreResult(const cv::Mat& left, const cv::Mat& right, float invalid) {
  Pipeline pipeline(settings().pipeline);
  cv::Mat map = pipeline.run(left, right).disparity;
  for (int y = 0; y < map.rows; ++y) {
    for (int x = 0; x < map.cols; ++x) {
      float& d = map.at<float>(y, x);
      if (std::isnan(d)) d = invalid;
    }
  }
  return map;
}

void expectEqualToCore(const FrameOutput& output, const cv::Mat& left, const cv::Mat& right, const std::string& name) {
  const cv::Mat expected = coreResult(left, right, -1.0F);
  EXPECT_EQ(cv::norm(pixels(output.disparity->image), expected, cv::NORM_INF), 0.0) << name;
}

TEST(FrameProcessor, PlaneComesOutWithItsDepth) {
  const FrameOutput output = run(goodMessages());
  EXPECT_GT(shareAt(output, kPlaneDisparity), 0.85);
  const cv::Mat depth = pixels(*output.depth);
  EXPECT_NEAR(depth.at<float>(60, 80), kFocal * kBaseline / kPlaneDisparity, 0.05);
  EXPECT_EQ(output.depth_info->P, goodMessages().left_info.P);
  EXPECT_GT(pixels(*output.confidence).at<float>(60, 80), 0.0F);
  EXPECT_EQ(output.seeds->encoding, "bgr8");
  EXPECT_EQ(output.seeds->width, 160U);
  EXPECT_GT(output.report.valid_share, 0.85);
  EXPECT_TRUE(output.report.warnings.empty());
}

TEST(FrameProcessor, SeedsAreShownInDarkImagesWithHotPixels) {
  const auto pair = test::planePair(160, 120, kPlaneDisparity);
  Messages messages = goodMessages();
  cv::Mat left, right;
  pair.left.convertTo(left, CV_16U, 4.0, 1000.0);
  pair.right.convertTo(right, CV_16U, 4.0, 1000.0);
  left.at<std::uint16_t>(60, 80) = 65535;
  messages.left = imageMessage(left, "mono16");
  messages.right = imageMessage(right, "mono16");
  const auto brightness = [](const Messages& m) {
    const FrameOutput output = run(m);
    return cv::mean(decodeImage(*output.seeds, "seeds/image"))[1];
  };
  EXPECT_NEAR(brightness(messages), brightness(goodMessages()), 10.0);
}

TEST(FrameProcessor, DepthErrorIsThatOfTheFormula) {
  const Messages messages = goodMessages();
  const FrameOutput output = run(messages);
  const cv::Mat depth = pixels(*output.depth), error = pixels(*output.depth_error);
  Pipeline pipeline(settings().pipeline);
  const StereoFrame frame = messages.frame();
  const cv::Mat sigma = pipeline.run(decodeImage(*frame.left, "left"), decodeImage(*frame.right, "right")).sigma;
  int compared = 0;
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      const float z = depth.at<float>(y, x), s = sigma.at<float>(y, x);
      if (std::isnan(z) || std::isnan(s)) continue;
      ASSERT_NEAR(error.at<float>(y, x), z * z * s / (kFocal * kBaseline), 1e-4F * z);
      ++compared;
    }
  }
  EXPECT_GT(compared, 10000);
}

TEST(FrameProcessor, UnsurePointsAreLeftOutOfDepthAlone) {
  const FrameOutput all = run(goodMessages());
  NodeSettings strict = settings();
  strict.node.max_depth_error_m = cv::mean(pixels(*all.depth_error), pixels(*all.depth_error) > 0.0F)[0];
  strict.node.min_confidence = 0.9;
  const FrameOutput sure = run(goodMessages(), strict);
  const cv::Mat error = pixels(*all.depth_error), confidence = pixels(*all.confidence);
  int kept = 0;
  for (int y = 0; y < error.rows; ++y) {
    for (int x = 0; x < error.cols; ++x) {
      const bool expected =
          error.at<float>(y, x) <= strict.node.max_depth_error_m && confidence.at<float>(y, x) >= 0.9F;
      ASSERT_EQ(!std::isnan(pixels(*sure.depth).at<float>(y, x)), expected) << x << ", " << y;
      kept += expected ? 1 : 0;
    }
  }
  EXPECT_GT(kept, 1000);
  EXPECT_EQ(cv::norm(pixels(sure.disparity->image), pixels(all.disparity->image), cv::NORM_INF), 0.0);
}

TEST(FrameProcessor, WhatMaxDepthErrorKeepsIsThatExact) {
  NodeSettings strict = settings();
  strict.node.max_depth_error_m = 0.05;
  const FrameOutput output = run(goodMessages(), strict);
  const cv::Mat depth = pixels(*output.depth);
  const double truth = kFocal * kBaseline / kPlaneDisparity;
  const int kept = cv::countNonZero(depth == depth);
  const int exact = cv::countNonZero(cv::abs(depth - truth) <= 3.0 * strict.node.max_depth_error_m);
  EXPECT_GT(kept, 0);
  EXPECT_GE(exact, kept * 95 / 100);
}

TEST(FrameProcessor, WhatNobodyWantsIsNotMade) {
  FrameProcessor processor({});
  const FrameOutput output = processor.process(goodMessages().frame(), settings(), {});
  EXPECT_FALSE(output.disparity || output.depth || output.depth_info || output.confidence || output.seeds ||
               output.disparity_color || output.depth_error);
  EXPECT_GT(output.report.valid_share, 0.85);
}

/// Colours of the searched range, whatever the principal points are; black exactly where there is no disparity.
TEST(FrameProcessor, ColoursOfTheDisparity) {
  Messages messages = goodMessages();
  messages.right_info.P[2] += 20.0;
  const FrameOutput output = run(messages);
  ASSERT_TRUE(output.disparity_color);
  EXPECT_EQ(output.disparity_color->encoding, "bgr8");
  EXPECT_EQ(output.disparity_color->header.stamp, output.disparity->header.stamp);
  const cv::Mat map = pixels(output.disparity->image);
  const cv::Mat colours(map.rows, map.cols, CV_8UC3, output.disparity_color->data.data(), output.disparity_color->step);
  cv::Mat level(1, 1, CV_8UC1, cv::Scalar(std::round(255.0 * kPlaneDisparity / 31.0)));
  cv::Mat plane_colour;
  cv::applyColorMap(level, plane_colour, cv::COLORMAP_TURBO);
  EXPECT_LE(cv::norm(colours.at<cv::Vec3b>(60, 80), plane_colour.at<cv::Vec3b>(0, 0), cv::NORM_INF), 12.0);
  int wrong = 0;
  for (int y = 0; y < map.rows; ++y) {
    for (int x = 0; x < map.cols; ++x) {
      const bool black = colours.at<cv::Vec3b>(y, x) == cv::Vec3b(0, 0, 0);
      if (black != (map.at<float>(y, x) < output.disparity->min_disparity)) ++wrong;
    }
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_LT(map.at<float>(60, 3), output.disparity->min_disparity) << "the right camera cannot see it";
}

TEST(FrameProcessor, EncodingsGiveTheCoresPixels) {
  const auto pair = test::planePair(160, 120, kPlaneDisparity);
  Messages messages = goodMessages();
  const auto check = [&](const std::string& name, const cv::Mat& left, const cv::Mat& right) {
    expectEqualToCore(run(messages), left, right, name);
  };
  messages.left = imageMessage(pair.left, "mono8", 7);
  check("padded", pair.left, pair.right);

  cv::Mat left16;
  cv::Mat right16;
  pair.left.convertTo(left16, CV_16U, 16.0, 3.0);  // 12 bits
  pair.right.convertTo(right16, CV_16U, 16.0, 3.0);
  messages.left = imageMessage(left16, "mono16");
  messages.right = imageMessage(right16, "mono16");
  check("12 bit", left16, right16);
  for (auto* image : {&messages.left, &messages.right}) {
    for (std::size_t i = 0; i < image->data.size(); i += 2) std::swap(image->data[i], image->data[i + 1]);
    image->is_bigendian = 1;
  }
  check("big-endian", left16, right16);

  cv::Mat left_colour;
  cv::Mat right_colour;
  cv::applyColorMap(pair.left, left_colour, cv::COLORMAP_JET);
  cv::applyColorMap(pair.right, right_colour, cv::COLORMAP_JET);
  messages.left = imageMessage(left_colour, "bgr8");
  messages.right = imageMessage(right_colour, "bgr8");
  check("bgr8", left_colour, right_colour);
  cv::Mat left_rgb;
  cv::Mat right_rgb;
  cv::cvtColor(left_colour, left_rgb, cv::COLOR_BGR2RGB);
  cv::cvtColor(right_colour, right_rgb, cv::COLOR_BGR2RGB);
  messages.left = imageMessage(left_rgb, "rgb8");
  messages.right = imageMessage(right_rgb, "rgb8");
  check("rgb8", left_colour, right_colour);
}

TEST(FrameProcessor, OneGreyAndOneColourCamera) {
  Messages messages = goodMessages();
  cv::Mat colour;
  cv::cvtColor(decodeImage(messages.right, ""), colour, cv::COLOR_GRAY2BGR);
  messages.right = imageMessage(colour, "bgr8");
  const FrameOutput output = run(messages);
  EXPECT_GT(shareAt(output, kPlaneDisparity), 0.85);
  ASSERT_EQ(output.report.warnings.size(), 1U);
}

TEST(FrameProcessor, SaysWhatTheHeaderLacks) {
  Messages messages = goodMessages();
  messages.stamp(ros::Time());
  for (auto* header : {&messages.left.header, &messages.left_info.header, &messages.right_info.header}) {
    header->frame_id = "";
  }
  const FrameOutput output = run(messages);
  EXPECT_GT(shareAt(output, kPlaneDisparity), 0.85);
  ASSERT_EQ(output.report.warnings.size(), 2U);
  EXPECT_NE(output.report.warnings[0].find("stamp is 0"), std::string::npos);
  EXPECT_NE(output.report.warnings[1].find("frame_id"), std::string::npos);
}

/// Sizes at which windows, census codes and pyramids do not fit.
TEST(FrameProcessor, ImagesOfAnyShapeWithEveryPreset) {
  const cv::Size sizes[] = {{1, 1}, {2, 1}, {1, 2}, {3, 3}, {7, 5}, {2000, 2}, {2, 2000}, {8000, 2}};
  for (const std::string& preset : presetNames()) {
    NodeSettings s;
    s.pipeline = loadPreset(preset);
    s.pipeline.search = {0, 16};
    s.pipeline.local_expansion.iterations = 1;
    for (const cv::Size size : sizes) {
      const FrameOutput output = run(goodMessages(size.width, size.height), s);
      EXPECT_EQ(output.disparity->image.width, static_cast<unsigned>(size.width)) << preset;
      EXPECT_EQ(output.disparity->image.height, static_cast<unsigned>(size.height)) << preset;
      EXPECT_GT(output.disparity->valid_window.width, 0U) << preset << size;
    }
  }
}

TEST(FrameProcessor, VergedCameras) {
  Messages messages = goodMessages();
  messages.right_info.P[2] += 20.0;  // published d = 9 + 20
  const FrameOutput output = run(messages);
  EXPECT_GT(shareAt(output, kPlaneDisparity + 20), 0.85);
  EXPECT_FLOAT_EQ(output.disparity->min_disparity, 20.0F);
  EXPECT_NEAR(pixels(*output.depth).at<float>(60, 80), kFocal * kBaseline / (kPlaneDisparity + 20), 0.02);
}

/// P[3] of the left camera may be anything: the distance of the cameras counts.
TEST(FrameProcessor, DepthOfAPlaneForAnyOrigin) {
  const double baseline_px = kFocal * kBaseline;
  const double true_depth = kFocal * kBaseline / kPlaneDisparity;
  for (const double left : {0.0, -baseline_px, baseline_px, 0.5 * baseline_px, -7.3, 1e4}) {
    Messages messages = goodMessages();
    messages.left_info.P[3] = left;
    messages.right_info.P[3] = left - baseline_px;
    const FrameOutput output = run(messages);
    EXPECT_FLOAT_EQ(output.disparity->T, static_cast<float>(kBaseline)) << left;
    const cv::Mat depth = pixels(*output.depth);
    const int near_plane = cv::countNonZero(cv::abs(depth - true_depth) < 0.01 * true_depth);
    EXPECT_GT(near_plane, 0.85 * static_cast<double>(depth.total())) << left;
    EXPECT_EQ(output.depth_info->P, messages.left_info.P);
    EXPECT_TRUE(output.report.warnings.empty());
    const auto& notes = output.report.notes;
    ASSERT_EQ(notes.size(), left == 0.0 ? 1U : 2U);
    EXPECT_EQ(notes.back().find("beside the origin") != std::string::npos, left != 0.0) << notes.back();
  }
}

TEST(FrameProcessor, ToldWhatTheRangeCanSee) {
  Messages messages = goodMessages();
  NodeSettings s = settings();  // 0 to 31 px of 20 m px
  EXPECT_NE(run(messages, s).report.notes[0].find("sees from 0.645 m (disparities 0 to 31 px)"), std::string::npos);
  s.pipeline.search = {4, 28};
  EXPECT_NE(run(messages, s).report.notes[0].find("sees from 0.645 m to 5 m"), std::string::npos);
  s.pipeline.search = {0, 1000};  // no wider than the image
  EXPECT_NE(run(messages, s).report.notes[0].find("sees from 0.126 m"), std::string::npos);
  s.pipeline.search = {0, 8};
  messages.right_info.P[2] -= 20.0;
  const FrameReport beyond = run(messages, s).report;
  ASSERT_EQ(beyond.warnings.size(), 1U);
  EXPECT_NE(beyond.warnings[0].find("beyond infinity"), std::string::npos);
  EXPECT_NE(beyond.warnings[0].find("set min_disparity to 20"), std::string::npos);
}

/// Rows of the right image moved down.
Messages movedRows(double px) {
  Messages messages = goodMessages(320, 240);
  cv::Mat moved;
  cv::warpAffine(decodeImage(messages.right, ""), moved, cv::Matx23d(1, 0, 0, 0, 1, px), {320, 240}, cv::INTER_CUBIC,
                 cv::BORDER_REPLICATE);
  messages.right = imageMessage(moved, "mono8");
  return messages;
}

/// At every scale the limit and the text are px of the images as given.
TEST(FrameProcessor, RowsThatAreOffAreTold) {
  for (const double scale : {1.0, 0.5}) {
    NodeSettings s = settings();
    s.pipeline.scale = scale;
    s.pipeline.row_alignment.warn_px = 1.5;
    FrameProcessor processor({});
    const FrameReport report = processor.process(movedRows(2.0).frame(), s, {}).report;
    ASSERT_EQ(report.warnings.size(), 1U) << scale;
    EXPECT_NE(report.warnings[0].find("off by 2.0"), std::string::npos) << report.warnings[0];
    EXPECT_NE(report.warnings[0].find("constant model"), std::string::npos) << report.warnings[0];
    EXPECT_NEAR(report.pipeline.row_alignment.offset_rms_px, 2.0, 0.1);
    EXPECT_GT(report.pipeline.row_alignment.rms_before_px, 1.8);
    EXPECT_LT(report.pipeline.row_alignment.rms_after_px, 0.3);
    const FrameReport again = processor.process(movedRows(2.1).frame(), s, {}).report;
    ASSERT_EQ(again.warnings.size(), 1U);
    EXPECT_EQ(again.warnings[0], report.warnings[0]) << "one text, not one per pair";
    const FrameReport worse = processor.process(movedRows(3.5).frame(), s, {}).report;
    ASSERT_EQ(worse.warnings.size(), 1U);
    EXPECT_NE(worse.warnings[0].find("off by 3."), std::string::npos) << worse.warnings[0];
    s.pipeline.row_alignment.warn_px = 5.0;
    ++s.revision;
    EXPECT_TRUE(processor.process(movedRows(3.5).frame(), s, {}).report.warnings.empty());
  }
}

TEST(FrameProcessor, BinningKeepsTheDistance) {
  Messages messages = goodMessages();
  for (auto* info : {&messages.left_info, &messages.right_info}) {
    info->width *= 2;
    info->height *= 2;
    info->binning_x = info->binning_y = 2;
    for (const std::size_t i : {0, 2, 3, 5, 6}) info->P[i] *= 2.0;
  }
  const FrameOutput output = run(messages);
  EXPECT_FLOAT_EQ(output.disparity->f, kFocal);
  EXPECT_NEAR(pixels(*output.depth).at<float>(60, 80), kFocal * kBaseline / kPlaneDisparity, 0.05);
}

/// Consumers drop the smallest value of a fully dense map.
TEST(FrameProcessor, FilledMapsKeepTheUnseenBorderInvalid) {
  NodeSettings s = settings();
  s.pipeline.hole_filling.enabled = true;
  const FrameOutput output = run(goodMessages(), s);
  const cv::Mat map = pixels(output.disparity->image);
  EXPECT_FLOAT_EQ(map.at<float>(60, 0), -1.0F);
  EXPECT_FLOAT_EQ(map.at<float>(60, 80), pixels(run(goodMessages()).disparity->image).at<float>(60, 80));
  EXPECT_GT(output.report.valid_share, 0.9);
}

TEST(FrameProcessor, StepOfTheRefinement) {
  NodeSettings s = settings();
  EXPECT_FLOAT_EQ(run(goodMessages(), s).disparity->delta_d, 1.0F / 16.0F);
  s.pipeline.semi_global.subpixel = SubpixelFit::kNone;
  EXPECT_FLOAT_EQ(run(goodMessages(), s).disparity->delta_d, 1.0F);
}

TEST(FrameProcessor, NewParametersTakeEffectWithTheNextFrame) {
  FrameProcessor processor({});
  NodeSettings s = settings();
  processor.process(goodMessages().frame(), s, kAll);
  s.pipeline.search.count = 24;
  ++s.revision;
  EXPECT_FLOAT_EQ(processor.process(goodMessages().frame(), s, kAll).disparity->max_disparity, 23.0F);
}

TEST(FrameProcessor, ACancelledFrameGivesNothing) {
  FrameProcessor processor({});
  const std::atomic<bool> cancel{true};
  EXPECT_FALSE(processor.process(goodMessages().frame(), settings(), kAll, &cancel).disparity);
}

TEST(FrameProcessor, RefusesWhatCannotBeMatched) {
  const auto error = [](const Messages& messages, const NodeSettings& s) -> std::string {
    try {
      run(messages, s);
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "";
  };
  Messages messages = goodMessages();
  messages.right = imageMessage(cv::Mat(119, 160, CV_8UC1, cv::Scalar(0)), "mono8");
  EXPECT_NE(error(messages, settings()).find("160 x 119"), std::string::npos);
  messages = goodMessages();
  messages.left = imageMessage(cv::Mat(120, 160, CV_16UC1, cv::Scalar(0)), "mono16");
  EXPECT_NE(error(messages, settings()).find("16 bit"), std::string::npos);
  NodeSettings s = settings();
  s.pipeline.search.min = 160;
  EXPECT_NE(error(goodMessages(), s).find("min_disparity = 160"), std::string::npos);
  s.pipeline.search = {-1000, 800};
  EXPECT_NE(error(goodMessages(), s).find("min_disparity = -1000"), std::string::npos);
  s.pipeline.search = {0, 1000};
  const auto wide = run(goodMessages(), s);
  ASSERT_EQ(wide.report.warnings.size(), 1U);
  EXPECT_NE(wide.report.warnings[0].find("disparity_range = 1000"), std::string::npos);
}

/// A stream at 20 Hz that has run for a while, and what becomes of its next pair.
class Stream {
 public:
  explicit Stream(NodeSettings s = settings()) : settings_(std::move(s)) {
    for (int i = 0; i < 5; ++i) next(0.05);
  }
  FrameOutput next(double passed) {
    time_ += passed;
    last_ = test::noisyMessages(++number_, time_);
    return processor_->process(last_.frame(), settings_, kAll);
  }
  /// Whether a pair is what it would be by itself.
  void expectSingle(const FrameOutput& output, const std::string& reason) {
    EXPECT_NE(output.report.pipeline.temporal.reset.find(reason), std::string::npos)
        << reason << " in: " << output.report.pipeline.temporal.reset;
    const FrameOutput single = run(last_, settings_);
    EXPECT_EQ(output.disparity->image.data, single.disparity->image.data) << reason;
    EXPECT_EQ(output.confidence->data, single.confidence->data) << reason;
  }
  NodeSettings& set() { return settings_; }
  FrameProcessor& processor() { return *processor_; }

 private:
  NodeSettings settings_;
  std::unique_ptr<FrameProcessor> processor_ = std::make_unique<FrameProcessor>(StereoTopics{});
  Messages last_;
  double time_ = 100.0;
  int number_ = 0;
};

TEST(FrameProcessor, AStreamIsSteadied) {
  Stream stream;
  const FrameOutput output = stream.next(0.05);
  EXPECT_EQ(output.report.pipeline.temporal.reset, "");
  EXPECT_GT(output.report.pipeline.temporal.kept_share, 0.99);
  EXPECT_EQ(stream.next(0.9).report.pipeline.temporal.reset, "") << "a slow camera";
}

TEST(FrameProcessor, TheFirstPairAfterATimeJumpIsThatOfASingleFrame) {
  Stream stream;
  stream.expectSingle(stream.next(-3.0), "jumped back");
  EXPECT_EQ(stream.next(0.05).report.pipeline.temporal.reset, "");
  stream.expectSingle(stream.next(1.1), "more than a second");
  EXPECT_EQ(stream.next(0.05).report.pipeline.temporal.reset, "");
  stream.expectSingle(stream.next(1e9), "more than a second");
  EXPECT_EQ(stream.next(0.05).report.pipeline.temporal.reset, "");
  stream.processor().reset();
  stream.expectSingle(stream.next(0.05), "jumped back");
}

TEST(FrameProcessor, TheFirstPairWithNewParametersIsThatOfASingleFrame) {
  Stream stream;
  stream.set().pipeline.semi_global.p1 = 0.6;
  ++stream.set().revision;
  stream.expectSingle(stream.next(0.05), "new parameters");
  EXPECT_EQ(stream.next(0.05).report.pipeline.temporal.reset, "");
}

TEST(FrameProcessor, WithoutTemporalEveryPairIsASingleFrame) {
  NodeSettings s = settings();
  s.pipeline.temporal.enabled = false;
  Stream stream(s);
  stream.expectSingle(stream.next(0.05), "");
}

}  // namespace
}  // namespace fdp_stereo
