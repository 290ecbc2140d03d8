// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// steadiness PATH...: how steady and how right the disparity of a stream is, with and without a memory, and OpenCV's.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <functional>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "command_line.hpp"
#include "evaluation/peer.hpp"
#include "fdp_stereo/io.hpp"
#include "fdp_stereo/pipeline.hpp"
#include "streams.hpp"

namespace fdp_stereo {
namespace {

namespace fs = std::filesystem;

constexpr int kScored = 4;  // last pairs of a stream, whose errors count

struct Options {
  std::vector<std::string> paths;
  std::string preset = "fast";
  std::string picture;
  int frames = 12;
  int num_disparities = 64;
  double noise = 2.0;
};

/// The disparities of a stream by one method, and the CPU time of all pairs but the first.
struct Answers {
  std::vector<cv::Mat> disparities;
  double cpu_ms = 0.0;
};

double cpuMs() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

Answers runPipeline(const Stream& stream, const Options& options, bool memory) {
  PipelineParams params = loadPreset(options.preset);
  params.search.count = stream.num_disparities;
  params.threads = 1;
  Pipeline pipeline(params);
  pipeline.setStream(memory);
  Answers answers;
  for (const StreamFrame& frame : stream.frames) {
    const double start = cpuMs();
    answers.disparities.push_back(pipeline.run(frame.left, frame.right).disparity);
    if (answers.disparities.size() > 1) answers.cpu_ms += cpuMs() - start;
  }
  answers.cpu_ms /= static_cast<double>(std::max<std::size_t>(stream.frames.size(), 2) - 1);
  return answers;
}

Answers runPeer(const Stream& stream, Peer peer) {
  Answers answers;
  for (const StreamFrame& frame : stream.frames) {
    Scene scene;
    scene.left = frame.left;
    scene.right = frame.right;
    scene.num_disparities = stream.num_disparities;
    PeerMatcher matcher(peer, scene);
    const double start = cpuMs();
    matcher.compute();
    if (!answers.disparities.empty()) answers.cpu_ms += cpuMs() - start;
    answers.disparities.push_back(matcher.disparity());
  }
  answers.cpu_ms /= static_cast<double>(std::max<std::size_t>(stream.frames.size(), 2) - 1);
  return answers;
}

/// Shares in % of the pixels that are looked at.
struct Errors {
  double pixels = 0.0, answered = 0.0, wrong = 0.0;
  void add(const cv::Mat& disparity, const StreamFrame& frame, const cv::Mat& where) {
    const cv::Mat known = where & frame.visible;
    const cv::Mat has = (disparity == disparity) & known;
    pixels += cv::countNonZero(known);
    answered += cv::countNonZero(has);
    wrong += cv::countNonZero(has & (cv::abs(disparity - frame.truth) > 1.0));
  }
  double density() const { return 100.0 * answered / pixels; }
  double wrongShare() const { return 100.0 * wrong / answered; }
  double bad() const { return 100.0 * (pixels - answered + wrong) / pixels; }
};

/// Over the last pairs: of all pixels, of the object, and of what it has just left.
void printErrors(const Stream& stream, const Answers& answers) {
  Errors all, object, left_behind;
  for (std::size_t i = stream.frames.size() - kScored; i < stream.frames.size(); ++i) {
    const StreamFrame& frame = stream.frames[i];
    all.add(answers.disparities[i], frame, cv::Mat(frame.visible.size(), CV_8UC1, cv::Scalar(255)));
    object.add(answers.disparities[i], frame, frame.object);
    cv::Mat before = cv::Mat::zeros(frame.object.size(), CV_8UC1);
    for (std::size_t k = 1; k < kScored; ++k) before |= stream.frames[i - k].object;
    left_behind.add(answers.disparities[i], frame, before & ~frame.object);
  }
  std::printf(" density %5.1f wrong %5.2f bad 1 %5.2f", all.density(), all.wrongShare(), all.bad());
  if (object.pixels > 0.0) std::printf(" | object bad 1 %5.2f, left behind %5.2f", object.bad(), left_behind.bad());
}

double quantile(std::vector<double>& values, double share) {
  if (values.empty()) return 0.0;
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

/// Over the second half: share of the pixels whose answer comes or goes, and the deviation of those that always have
/// one.
void printSteadiness(const Answers& answers) {
  const std::size_t first = answers.disparities.size() / 2;
  const auto count = static_cast<double>(answers.disparities.size() - first);
  const cv::Size size = answers.disparities.front().size();
  cv::Mat sum = cv::Mat::zeros(size, CV_64F), squares = cv::Mat::zeros(size, CV_64F);
  double blinks = 0.0;
  for (std::size_t i = first; i < answers.disparities.size(); ++i) {
    cv::Mat now;
    answers.disparities[i].convertTo(now, CV_64F);
    sum += now;
    squares += now.mul(now);
    if (i == first) continue;
    const cv::Mat& before = answers.disparities[i - 1];
    blinks += cv::countNonZero((answers.disparities[i] == answers.disparities[i]) != (before == before));
  }
  std::vector<double> deviations;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const double mean = sum.at<double>(y, x) / count;
      if (std::isnan(mean)) continue;
      deviations.push_back(std::sqrt(std::max(0.0, squares.at<double>(y, x) / count - mean * mean)));
    }
  }
  std::printf(" | blink %5.2f deviation %.3f / %.3f", 100.0 * blinks / ((count - 1.0) * size.area()),
              quantile(deviations, 0.5), quantile(deviations, 0.95));
}

/// Of a recording: of the pixels around which the images hardly change, those whose answer comes or goes, and those
/// whose disparity jumps by more than 1 px.
void printRecording(const Stream& stream, const Answers& answers) {
  constexpr double kStill = 2.0;  // grey levels, mean over 15 x 15 px
  double still_pixels = 0.0, blinks = 0.0, jumps = 0.0;
  for (std::size_t i = 1; i < stream.frames.size(); ++i) {
    cv::Mat change;
    cv::absdiff(stream.frames[i].left, stream.frames[i - 1].left, change);
    cv::blur(change, change, {15, 15});
    const cv::Mat still = change < kStill;
    const cv::Mat &now = answers.disparities[i], &before = answers.disparities[i - 1];
    still_pixels += cv::countNonZero(still);
    blinks += cv::countNonZero(((now == now) != (before == before)) & still);
    jumps += cv::countNonZero((cv::abs(now - before) > 1.0) & still);
  }
  std::printf(" | of %4.1f %% still: blink %5.2f jump %5.2f",
              100.0 * still_pixels / static_cast<double>((stream.frames.size() - 1) * stream.frames[0].left.total()),
              100.0 * blinks / still_pixels, 100.0 * jumps / still_pixels);
}

void measure(const Stream& stream, const char* motion, const Options& options) {
  const std::vector<std::pair<std::string, std::function<Answers()>>> methods = {
      {options.preset + ", a memory", [&] { return runPipeline(stream, options, true); }},
      {options.preset + ", single", [&] { return runPipeline(stream, options, false); }},
      {"sgbm_hh", [&] { return runPeer(stream, Peer::kSgbmHh); }},
      {"sgbm_3way", [&] { return runPeer(stream, Peer::kSgbm3Way); }}};
  for (const auto& [name, run] : methods) {
    const Answers answers = run();
    std::printf("%-14s %-9s %-16s CPU ms %6.1f", stream.name.c_str(), motion, name.c_str(), answers.cpu_ms);
    if (!stream.frames.front().truth.empty()) printErrors(stream, answers);
    if (std::string(motion) == "static") printSteadiness(answers);
    if (std::string(motion) == "recorded") printRecording(stream, answers);
    std::printf("\n");
    std::fflush(stdout);
  }
}

/// One row of pixels over the pairs of a static stream, one below the other: single pairs above, with a memory below.
void drawRow(const Scene& scene, const Options& options) {
  constexpr int kHigh = 8, kGap = 16;  // px of a pair, and between the two
  const Stream stream = makeStream(scene, Motion::kStatic, options.frames, options.noise);
  const int row = scene.left.rows / 2;
  const auto strip = [&](bool memory) {
    cv::Mat rows;
    for (const cv::Mat& disparity : runPipeline(stream, options, memory).disparities)
      rows.push_back(disparity.row(row));
    cv::Mat colours = colorize(rows, {0, stream.num_disparities});
    cv::resize(colours, colours, {}, 1.0, kHigh, cv::INTER_NEAREST);
    return colours;
  };
  const cv::Mat single = strip(false), memory = strip(true);
  cv::Mat picture;
  cv::vconcat(std::vector<cv::Mat>{single, cv::Mat(kGap, single.cols, CV_8UC3, cv::Scalar::all(255)), memory}, picture);
  writeImage(options.picture, picture);
}

Scene sceneOf(const fs::path& folder, int num_disparities) {
  if (!fs::exists(folder / "left.png")) return readScene(findScenes(folder.string()).front());
  Scene scene;
  scene.name = folder.filename().string();
  scene.left = readImage((folder / "left.png").string());
  scene.right = readImage((folder / "right.png").string());
  scene.truth = cv::Mat(scene.left.size(), CV_32FC1, cv::Scalar(kInvalidDisparity));
  scene.num_disparities = num_disparities;
  return scene;
}

int steadiness(const Options& options) {
  if (!options.picture.empty()) {
    drawRow(sceneOf(options.paths.front(), options.num_disparities), options);
    return 0;
  }
  for (const std::string& path : options.paths) {
    if (fs::exists(fs::path(path) / "mav0")) {
      measure(readRecording(path, options.num_disparities), "recorded", options);
      continue;
    }
    for (const SceneFiles& files : findScenes(path)) {
      const Scene scene = readScene(files);
      measure(makeStream(scene, Motion::kStatic, options.frames, options.noise), "static", options);
      measure(makeStream(scene, Motion::kPan, options.frames, options.noise), "pan", options);
      measure(makeStream(scene, Motion::kObject, options.frames, options.noise), "object", options);
    }
  }
  return 0;
}

void addOptions(CLI::App& app, Options& options) {
  app.add_option("PATH", options.paths, "Folders of scenes, as evaluate takes them, or of recordings in EuRoC's form")
      ->required();
  app.add_option("--preset", options.preset, "Preset by name, or a YAML file")->capture_default_str();
  app.add_option("--frames", options.frames, "Pairs of a stream")->check(CLI::Range(8, 1000))->capture_default_str();
  app.add_option("--noise", options.noise, "Standard deviation of the noise in every pair, grey levels")
      ->check(CLI::Range(0.0, 50.0))
      ->capture_default_str();
  app.add_option("--num-disparities", options.num_disparities, "Of recordings and of pairs without truth")
      ->check(CLI::Range(16, 1024))
      ->capture_default_str();
  app.add_option("--picture", options.picture,
                 "Draw one row of the first scene (or of left.png and right.png) over all pairs and end");
}

}  // namespace
}  // namespace fdp_stereo

int main(int argc, char** argv) {
  CLI::App app("How steady and how right the disparity of a stream is", "steadiness");
  fdp_stereo::Options options;
  fdp_stereo::addOptions(app, options);
  return fdp_stereo::runTool(app, argc, argv, [&] { return fdp_stereo::steadiness(options); });
}
