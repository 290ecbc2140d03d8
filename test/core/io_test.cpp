// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/io.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <random>
#include <thread>

#include <sys/stat.h>

namespace fdp_stereo {
namespace {

std::string tempPath(const std::string& name) { return testing::TempDir() + "/fdp_stereo_io_" + name; }

std::string write(const std::string& name, const std::string& bytes) {
  const std::string path = tempPath(name);
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

std::string read(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

template <typename Call>
std::string errorOf(Call&& call) {
  try {
    call();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

void expectContains(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << "'" << text << "' lacks '" << part << "'";
}

cv::Mat randomDisparity(int rows, int cols) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> value(0.01F, 250.0F);
  cv::Mat map(rows, cols, CV_32FC1);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < cols; ++x) map.at<float>(y, x) = random() % 5 == 0 ? kInvalidDisparity : value(random);
  }
  return map;
}

void expectSame(const cv::Mat& actual, const cv::Mat& expected, float tolerance) {
  ASSERT_EQ(actual.size(), expected.size());
  for (int y = 0; y < expected.rows; ++y) {
    for (int x = 0; x < expected.cols; ++x) {
      const float a = actual.at<float>(y, x);
      const float e = expected.at<float>(y, x);
      ASSERT_EQ(std::isnan(a), std::isnan(e)) << x << ", " << y;
      if (std::isnan(e)) continue;
      ASSERT_NEAR(a, e, tolerance) << x << ", " << y;
    }
  }
}

// A file of 2 x 2 floats, worked by hand: rows run from the bottom up; 1.0F is 3f800000, 2.0F 40000000,
// infinity 7f800000, 0.5F 3f000000.
const cv::Mat kHandWorked = (cv::Mat_<float>(2, 2) << kInvalidDisparity, 0.5F, 1.0F, 2.0F);

TEST(Pfm, ReadsLittleEndianFromTheBottomUp) {
  const std::string floats("\0\0\x80\x3f\0\0\0\x40\0\0\x80\x7f\0\0\0\x3f", 16);
  expectSame(readDisparity(write("little.pfm", "Pf\n2 2\n-1.0\n" + floats)), kHandWorked, 0.0F);
}

TEST(Pfm, ReadsBigEndianAndComments) {
  const std::string floats("\x3f\x80\0\0\x40\0\0\0\x7f\x80\0\0\x3f\0\0\0", 16);
  expectSame(readDisparity(write("big.PFM", "Pf\n# by hand\n2 2\n1.0\n" + floats)), kHandWorked, 0.0F);
}

/// netpbm separates the fields by any white space, and ends the header with one character of it.
TEST(Pfm, ReadsHeadersOfOtherPrograms) {
  const std::string floats("\x0a\x0d\x80\x3f\0\0\0\x40\0\0\x80\x7f\0\0\0\x3f", 16);  // begins like a line's end
  const cv::Mat expected = readDisparity(write("plain.pfm", "Pf\n2 2\n-1\n" + floats));
  ASSERT_FLOAT_EQ(expected.at<float>(1, 1), 2.0F);
  for (const char* header : {"Pf\n2\n2\n-1\n", "Pf 2 2 -1\n", "Pf\n2 2 -1\n", "Pf\n\n2 2\n-1\n", "Pf\t2\t2\t-1 ",
                             "Pf\r\n2 2\r\n-1.0\r\n", "Pf\n2 2\n-1.0 \n", "Pf\n2 2 # size\n-1 # little\n",
                             "Pf # a\n# b\n 2 # c\n2\n-0.0039\n", "Pf\r2 2\r-1\r", "Pf\n2 2\n-1e0\n"}) {
    expectSame(readDisparity(write("other.pfm", header + floats)), expected, 0.0F);
    const bool line_ends = std::string(header).back() == '\n';  // else trailing bytes make the data's place a guess
    if (line_ends) expectSame(readDisparity(write("other.pfm", header + floats + "trailing")), expected, 0.0F);
  }
}

TEST(Pfm, WritesWhatItReads) {
  const cv::Mat map = randomDisparity(7, 13);
  const std::string path = tempPath("round.pfm");
  writeDisparity(path, map);
  expectSame(readDisparity(path), map, 0.0F);
  EXPECT_EQ(read(path).size(), std::string("Pf\n13 7\n-1.0\n").size() + 4 * 7 * 13);
}

TEST(Pfm, RefusesBrokenFiles) {
  const std::string floats(16, '\0');
  const auto error = [](const std::string& bytes) {
    return errorOf([&] { readDisparity(write("broken.pfm", bytes)); });
  };
  expectContains(error(""), "missing, empty");
  expectContains(error("PF\n2 2\n-1.0\n" + floats), "3 channels");
  expectContains(error("P5\n2 2\n255\n" + floats), "not a PFM");
  expectContains(error("Pf\n2\n-1.0\n" + floats), "broken PFM header");
  expectContains(error("Pf\n2 2\n0\n" + floats), "broken PFM header");
  expectContains(error("Pf\n2 2\nabc\n" + floats), "broken PFM header");
  expectContains(error("Pf\n0 2\n-1\n" + floats), "claims 0 x 2 px");
  expectContains(error("Pf\n-2 2\n-1\n" + floats), "claims -2 x 2 px");
  expectContains(error("Pf\n2 3\n-1\n" + floats), "truncated");
  expectContains(error("Pf\n2 2\n"), "broken PFM header");
  expectContains(error("Pf\n100000 100000\n-1\n" + floats), "claims 100000 x 100000 px");
  expectContains(error("Pf\n32768 32768\n-1\n" + floats), "truncated");
  expectContains(error("Pf\n99999999999999999999 1\n-1\n" + floats), "broken PFM header");
  expectContains(error(std::string(100000, 'P')), "not a PFM");
  expectContains(error("Pf" + floats), "not a PFM");
  expectContains(error("Pf\n2 2 # " + std::string(100000, ' ')), "broken PFM header");
  expectContains(error("Pf 2 2.5 -1\n" + floats), "broken PFM header");
}

TEST(PngDisparity, RoundTripsTo256thsOfAPixel) {
  const cv::Mat map = randomDisparity(9, 11);
  const std::string path = tempPath("round.png");
  writeDisparity(path, map);
  expectSame(readDisparity(path), map, 0.5F / 256.0F + 1e-5F);
}

TEST(PngDisparity, ZeroPixelsAreKeptApartFromNone) {
  const std::string path = tempPath("zero.png");
  writeDisparity(path, (cv::Mat_<float>(1, 2) << 0.0F, kInvalidDisparity));
  const cv::Mat map = readDisparity(path);
  EXPECT_FLOAT_EQ(map.at<float>(0, 0), 1.0F / 256.0F);
  EXPECT_TRUE(std::isnan(map.at<float>(0, 1)));
}

TEST(PngDisparity, UsesTheScaleOfTheFile) {
  const std::string path = tempPath("scale.png");
  const cv::Mat raw = (cv::Mat_<std::uint8_t>(1, 3) << 0, 40, 255);
  ASSERT_TRUE(cv::imwrite(path, raw));
  const cv::Mat map = readDisparity(path, 4.0);
  EXPECT_TRUE(std::isnan(map.at<float>(0, 0)));
  EXPECT_FLOAT_EQ(map.at<float>(0, 1), 10.0F);
  EXPECT_FLOAT_EQ(map.at<float>(0, 2), 63.75F);
  EXPECT_THROW(readDisparity(path, 0.0), std::invalid_argument);
}

TEST(PngDisparity, TakesGreyStoredAsColour) {
  const std::string path = tempPath("color.png");
  ASSERT_TRUE(cv::imwrite(path, cv::Mat(2, 2, CV_8UC3, cv::Scalar(40, 40, 40))));
  EXPECT_FLOAT_EQ(readDisparity(path, 4.0).at<float>(0, 0), 10.0F);
  ASSERT_TRUE(cv::imwrite(path, cv::Mat(2, 2, CV_8UC3, cv::Scalar(40, 41, 40))));
  expectContains(errorOf([&] { readDisparity(path); }), "must be grey");
}

TEST(PngDisparity, RefusesWhatItCannotHold) {
  const auto error = [](float d) {
    return errorOf([&] { writeDisparity(tempPath("hold.png"), cv::Mat(1, 1, CV_32FC1, cv::Scalar(d))); });
  };
  EXPECT_EQ(error(255.99F), "");
  expectContains(error(256.5F), "use .pfm");
  expectContains(error(-1.0F), "use .pfm");
}

TEST(WriteDisparity, RefusesOtherTypesAndPlaces) {
  const cv::Mat map(2, 2, CV_32FC1, cv::Scalar(1.0));
  expectContains(errorOf([&] { writeDisparity(tempPath("map.jpg"), map); }), ".pfm or .png");
  expectContains(errorOf([&] { writeDisparity(tempPath("map"), map); }), ".pfm or .png");
  expectContains(errorOf([&] { writeDisparity("/does/not/exist/map.pfm", map); }), "cannot be written");
  expectContains(errorOf([&] { writeDisparity("/does/not/exist/map.png", map); }), "cannot be written");
  EXPECT_THROW(writeDisparity(tempPath("map.pfm"), cv::Mat(2, 2, CV_8UC1)), std::invalid_argument);
  EXPECT_THROW(writeDisparity(tempPath("map.pfm"), cv::Mat()), std::invalid_argument);
}

TEST(ReadImage, KeepsDepthAndChannels) {
  const std::string path = tempPath("image.png");
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1, CV_16UC3}) {
    cv::Mat image(5, 4, type, cv::Scalar(1, 2, 3));
    ASSERT_TRUE(cv::imwrite(path, image));
    const cv::Mat back = readImage(path);
    ASSERT_EQ(back.type(), type);
    EXPECT_EQ(cv::norm(back, image, cv::NORM_INF), 0.0);
  }
  ASSERT_TRUE(cv::imwrite(path, cv::Mat(5, 4, CV_8UC4, cv::Scalar(1, 2, 3, 4))));
  EXPECT_EQ(readImage(path).type(), CV_8UC3);
}

std::string encoded(const char* type, const cv::Mat& image) {
  std::vector<std::uint8_t> bytes;
  EXPECT_TRUE(cv::imencode(type, image, bytes));
  return {bytes.begin(), bytes.end()};
}

cv::Mat noise(int rows, int cols, int type) {
  cv::Mat image(rows, cols, type);
  cv::randu(image, 0, 255);
  return image;
}

TEST(DecodeImageFile, GivesWhatReadImageGives) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1, CV_16UC3, CV_8UC4}) {
    const std::string bytes = encoded(".png", noise(5, 4, type));
    const cv::Mat image = decodeImageFile(bytes, "topic");
    EXPECT_EQ(image.channels(), type == CV_8UC1 || type == CV_16UC1 ? 1 : 3);
    EXPECT_EQ(cv::norm(image, readImage(write("same.png", bytes)), cv::NORM_INF), 0.0);
  }
}

TEST(DecodeImageFile, NamesWhatIsWrong) {
  const auto error = [](const std::string& bytes) { return errorOf([&] { decodeImageFile(bytes, "/left"); }); };
  const std::string jpeg = encoded(".jpg", noise(40, 50, CV_8UC3));
  EXPECT_EQ(error(jpeg), "");
  EXPECT_EQ(error(jpeg + "what a camera appends"), "");
  expectContains(error(""), "/left: not readable as an image: it is empty");
  expectContains(error("random bytes"), "not PNG");
  for (const std::size_t kept : {std::size_t{4}, std::size_t{100}, jpeg.size() / 2, jpeg.size() - 1}) {
    expectContains(error(jpeg.substr(0, kept)), "truncated JPEG");
  }
  for (const std::size_t kept : {std::size_t{1}, std::size_t{2}})
    expectContains(error(jpeg.substr(0, kept)), "not PNG");
  const std::string png = encoded(".png", noise(40, 50, CV_8UC1));
  expectContains(errorOf([&] { decodeImageFile(png, "/left", 1999); }), "claims 50 x 40 px, allowed are 1999");
  EXPECT_EQ(errorOf([&] { decodeImageFile(png, "/left", 2000); }), "");
}

/// Every format's header with 60000 x 60000 px, and with more than so few bytes can hold.
TEST(DecodeImageFile, RefusesSizesBeforeItDecodes) {
  const auto error = [](std::string bytes, std::size_t at, const std::string& sides) {
    return errorOf([&] { decodeImageFile(bytes.replace(at, sides.size(), sides), "/left"); });
  };
  const cv::Mat image = noise(40, 50, CV_8UC3);
  const std::string jpeg = encoded(".jpg", image);
  const std::size_t frame = jpeg.find("\xff\xc0") + 5;
  expectContains(error(jpeg, frame, "\xea\x60\xea\x60"), "claims 60000 x 60000 px");
  expectContains(error(jpeg, frame, "\x75\x30\x75\x30"), "bytes can hold");
  expectContains(error(encoded(".png", image), 16, std::string("\0\0\xea\x60\0\0\xea\x60", 8)),
                 "claims 60000 x 60000 px");
  expectContains(error(encoded(".bmp", image), 18, std::string("\x60\xea\0\0\x60\xea\0\0", 8)), "claims 60000 x 60000");
  expectContains(error("P5 60000 60000 255\n", 0, "P"), "claims 60000 x 60000 px");
  expectContains(error("P5 99999999999999999999 1 255\n", 0, "P"), "claims 1099511627776 x 1 px");
  expectContains(error("P6 # no size\n", 0, "P"), "claims 0 x 0 px");
  expectContains(error("P6 3000 3000 255\n", 0, "P"), "bytes can hold");
  expectContains(error(encoded(".bmp", image), 18, std::string("\xb8\x0b\0\0\xb8\x0b\0\0", 8)), "bytes can hold");
  const std::string webp = encoded(".webp", image);
  ASSERT_EQ(decodeImageFile(webp, "webp").size(), image.size());
  const std::string tiff = encoded(".tiff", image);
  const std::size_t width = tiff.find(std::string("\x00\x01\x03\x00\x01\x00\x00\x00\x32\x00", 10));
  ASSERT_NE(width, std::string::npos);
  expectContains(error(tiff, width + 8, "\x60\xea"), "claims 60000 x 40 px");
  std::string large = tiff;
  large.replace(width + 8, 2, "\xff\x7f").replace(width + 20, 2, "\xff\x7f");
  expectContains(error(large, 0, ""), "claims 32767 x 32767 px, allowed are " + std::to_string(kMaxImagePixels));
}

/// A second frame before the end marker: libjpeg takes the first one's size.
TEST(DecodeImageFile, TheLargestClaimOfAFileCounts) {
  const std::string small = encoded(".jpg", noise(40, 50, CV_8UC3));
  std::string large = small;
  large.replace(large.find("\xff\xc0") + 5, 4, "\x75\x30\x75\x30");
  large.resize(large.size() - 2);
  expectContains(errorOf([&] { decodeImageFile(large + small, "/left"); }), "claims 30000 x 30000 px");
}

TEST(ReadImage, ReadsPipes) {
  const std::string path = tempPath("pipe.png");
  std::filesystem::remove(path);
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  const cv::Mat image = noise(300, 400, CV_8UC3);  // more than a pipe holds
  std::thread writer([&] { std::ofstream(path, std::ios::binary) << encoded(".png", image); });
  EXPECT_EQ(cv::norm(readImage(path), image, cv::NORM_INF), 0.0);
  writer.join();
  std::filesystem::remove(path);
}

TEST(WriteFile, LeavesNothingHalf) {
  const std::string path = tempPath("whole.txt");
  writeFile(path, "first");
  writeFile(path, "second");
  EXPECT_EQ(read(path), "second");
  EXPECT_FALSE(std::filesystem::exists(path + ".partial"));
  const std::string link = tempPath("link.txt");
  std::filesystem::remove(link);
  std::filesystem::create_symlink(path, link);
  writeFile(link, "through a link");
  EXPECT_EQ(read(path), "through a link");
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  writeFile("/dev/null", "gone");
  EXPECT_FALSE(std::filesystem::is_regular_file("/dev/null"));
  expectContains(errorOf([] { writeFile(testing::TempDir(), "x"); }), "cannot be written");
  expectContains(errorOf([] { writeFile("/does/not/exist", "x"); }),
                 "/does/not/exist: cannot be written: No such file");
}

TEST(WriteImage, RefusesWhatTheFormatCannotHold) {
  expectContains(errorOf([] { writeImage(tempPath("a.xyz"), noise(2, 2, CV_8UC1)); }), "an image must be .png");
  expectContains(errorOf([] { writeImage(tempPath("a.jpg"), cv::Mat(2, 2, CV_16UC1, cv::Scalar(1))); }), "8 bits");
  EXPECT_THROW(writeImage(tempPath("a.png"), cv::Mat()), std::invalid_argument);
}

TEST(ReadImage, RefusesBrokenPngs) {
  const std::string path = tempPath("whole.png");
  cv::Mat noise(40, 50, CV_8UC3);
  cv::randu(noise, 0, 255);
  ASSERT_TRUE(cv::imwrite(path, noise));
  const std::string whole = read(path);
  for (const std::size_t kept : {std::size_t{20}, std::size_t{40}, whole.size() / 2, whole.size() - 13}) {
    expectContains(errorOf([&] { readImage(write("cut.png", whole.substr(0, kept))); }), "truncated PNG");
  }
  std::string bomb = whole;
  bomb.replace(16, 8, std::string("\0\0\x75\x30\0\0\x75\x30", 8));  // 30000 x 30000
  expectContains(errorOf([&] { readImage(write("bomb.png", bomb)); }), "bytes can hold");
  bomb.replace(16, 4, std::string("\x7f\xff\xff\xff", 4));
  expectContains(errorOf([&] { readImage(write("bomb.png", bomb)); }), "claims 2147483647 x");
}

TEST(ReadImage, TakesTheFormatsItNames) {
  const cv::Mat image(5, 7, CV_8UC3, cv::Scalar(10, 20, 30));
  for (const char* type : {"png", "jpg", "tiff", "bmp", "webp", "ppm"}) {
    const std::string path = testing::TempDir() + "image." + type;
    ASSERT_TRUE(cv::imwrite(path, image)) << type;
    EXPECT_EQ(readImage(path).size(), image.size()) << type;
  }
}

/// Found by the fuzzer: OpenCV takes this for DICOM by its content, whose library ends the process on it.
TEST(ReadImage, RefusesWhatOpenCvWouldTakeForAnotherFormat) {
  std::string dicom(128, '\xd5');
  dicom += "DICM2 V";
  expectContains(errorOf([&] { readImage(write("picture.png", dicom)); }), "not PNG");
}

TEST(ReadImage, NamesTheFile) {
  expectContains(errorOf([] { readImage("/does/not/exist.png"); }), "/does/not/exist.png: missing");
  expectContains(errorOf([] { readImage(testing::TempDir()); }), testing::TempDir());
  expectContains(errorOf([] { readImage(write("text.png", "no image at all")); }), "not readable as an image");
}

TEST(Seeds, ReadsText) {
  const Seeds seeds = readSeeds(write("seeds.txt", "# x y d trust\n1 2 3.5\n\n4.25 5 6 0.5  # doubtful\r\n"));
  ASSERT_EQ(seeds.size(), 2U);
  EXPECT_FLOAT_EQ(seeds[0].x, 1.0F);
  EXPECT_FLOAT_EQ(seeds[0].y, 2.0F);
  EXPECT_FLOAT_EQ(seeds[0].d, 3.5F);
  EXPECT_FLOAT_EQ(seeds[0].trust, 1.0F);
  EXPECT_EQ(seeds[0].source, SeedSource::kFile);
  EXPECT_FLOAT_EQ(seeds[1].x, 4.25F);
  EXPECT_FLOAT_EQ(seeds[1].trust, 0.5F);
}

TEST(Seeds, NamesTheBrokenLine) {
  for (const char* line : {"1 2", "a b c", "1 2 3 1.5", "1 2 3 -0.1", "1 2 3 0.5 6", "1 2 nan", "1 2 3 x"}) {
    expectContains(errorOf([&] { readSeeds(write("bad.txt", std::string("1 2 3\n") + line + "\n")); }),
                   "bad.txt:2: must be");
  }
}

TEST(Seeds, RefusesLinesWithoutEnd) {
  expectContains(errorOf([] { readSeeds("/dev/zero"); }), "/dev/zero:1: longer than");
  EXPECT_EQ(readSeeds(write("no_end.txt", "1 2 3\n4 5 6")).size(), 2U);
}

TEST(Seeds, RefusesMapsOfAnotherSize) {
  const std::string path = tempPath("half.pfm");
  writeDisparity(path, cv::Mat(2, 3, CV_32FC1, cv::Scalar(1.0)));
  EXPECT_EQ(readSeeds(path, {3, 2}).size(), 6U);
  expectContains(errorOf([&] { readSeeds(path, {6, 4}); }), "is 3 x 2 px, the left image 6 x 4 px");
}

TEST(Seeds, ReadsMaps) {
  const std::string path = tempPath("seeds.pfm");
  writeDisparity(path, (cv::Mat_<float>(2, 2) << kInvalidDisparity, 0.5F, kInvalidDisparity, 2.0F));
  const Seeds seeds = readSeeds(path);
  ASSERT_EQ(seeds.size(), 2U);
  EXPECT_FLOAT_EQ(seeds[1].x, 1.0F);
  EXPECT_FLOAT_EQ(seeds[1].y, 1.0F);
  EXPECT_FLOAT_EQ(seeds[1].d, 2.0F);
}

TEST(NoneMask, FindsNanAtEveryColumn) {
  cv::Mat map(3, 41, CV_32FC1, cv::Scalar(1.0));
  for (int x = 0; x < map.cols; x += 3) map.at<float>(1, x) = kInvalidDisparity;
  const cv::Mat mask = noneMask(map);
  for (int x = 0; x < map.cols; ++x) {
    EXPECT_EQ(mask.at<std::uint8_t>(1, x), x % 3 == 0 ? 255 : 0) << x;
    EXPECT_EQ(mask.at<std::uint8_t>(0, x), 0) << x;
  }
}

TEST(Colorize, NoneIsBlackAndNearIsRed) {
  const cv::Mat colors = colorize((cv::Mat_<float>(1, 3) << kInvalidDisparity, 2.0F, 60.0F), {0, 64});
  EXPECT_EQ(colors.at<cv::Vec3b>(0, 0), cv::Vec3b(0, 0, 0));
  const cv::Vec3b far = colors.at<cv::Vec3b>(0, 1);
  const cv::Vec3b near = colors.at<cv::Vec3b>(0, 2);
  EXPECT_GT(far[0], far[2]);
  EXPECT_GT(near[2], near[0]);
}

TEST(Colorize, RefusesOtherTypes) {
  EXPECT_THROW(colorize(cv::Mat(2, 2, CV_8UC1), {0, 16}), std::invalid_argument);
  EXPECT_THROW(colorize(cv::Mat(), {0, 16}), std::invalid_argument);
  EXPECT_THROW(confidenceToGrey(cv::Mat(2, 2, CV_64FC1)), std::invalid_argument);
}

TEST(ConfidenceToGrey, ScalesAndRounds) {
  const cv::Mat grey = confidenceToGrey((cv::Mat_<float>(1, 4) << 0.0F, 0.5F, 1.0F, kInvalidDisparity));
  EXPECT_EQ(grey.at<std::uint8_t>(0, 0), 0);
  EXPECT_NEAR(grey.at<std::uint8_t>(0, 1), 128, 1);
  EXPECT_EQ(grey.at<std::uint8_t>(0, 2), 255);
  EXPECT_EQ(grey.at<std::uint8_t>(0, 3), 0);
}

}  // namespace
}  // namespace fdp_stereo
