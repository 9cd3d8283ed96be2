#include "calib/present/frames/cloud_frame.h"

#include <cmath>
#include <limits>
#include <set>

#include "tests/unit/present/frames/frame_testing.h"

namespace rgbdt {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr Utime kNow = 1'700'000'000'123'457;

// A point as the page reads it.
struct Point {
  float x, y, z;
  int red, green, blue, intensity;
  float temperature_k, counts;
  int sigma_mk, valid;
  std::uint32_t offset_us;
};

std::vector<Point> PointsOf(const ParsedFrame& frame) {
  const std::string& bytes = frame.arrays.at("points");
  std::vector<Point> points;
  for (std::size_t at = 0; at < bytes.size(); at += 32) {
    const auto real = [&](std::size_t offset) {
      float number = 0;
      std::memcpy(&number, &bytes[at + offset], sizeof number);
      return number;
    };
    const auto octet = [&](std::size_t offset) {
      return static_cast<int>(static_cast<unsigned char>(bytes[at + offset]));
    };
    const auto pair = [&](std::size_t offset) { return octet(offset) + 256 * octet(offset + 1); };
    points.push_back({real(0), real(4), real(8), octet(12), octet(13), octet(14), octet(15),
                      real(16), real(20), pair(24), pair(26), NumberAt(bytes, at + 28)});
  }
  return points;
}

void AddPoint(const Eigen::Vector3f& at, RgbdtCloud* cloud) {
  cloud->points.push_back(at);
  cloud->intensity.push_back(0.5F);
  cloud->utime.push_back(kNow);
  cloud->rgb.push_back({1, 2, 3});
  cloud->temperature_k.push_back(kNan);
  cloud->temperature_sigma_k.push_back(kNan);
  cloud->thermal_counts.push_back(kNan);
  cloud->valid.push_back(0);
}

// Points whose x and y are their line and beam.
RgbdtCloud GridCloud(int lines, int beams) {
  RgbdtCloud cloud;
  for (int line = 0; line < lines; ++line) {
    for (int beam = 0; beam < beams; ++beam) {
      AddPoint({static_cast<float>(line), static_cast<float>(beam), 0}, &cloud);
    }
  }
  return cloud;
}

TEST(CloudFrame, EveryFieldOfAPointRoundTrips) {
  RgbdtCloud cloud = GridCloud(1, 101);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto number = static_cast<float>(i);
    const auto octet = static_cast<std::uint8_t>(i);
    cloud.points[i] = {number, -number / 3, 1000 + number};
    cloud.rgb[i] = {octet, static_cast<std::uint8_t>(255 - octet), static_cast<std::uint8_t>(7)};
    cloud.intensity[i] = number / 254;
    cloud.temperature_k[i] = 273.15F + number;
    cloud.thermal_counts[i] = 7000.25F + number;
    cloud.temperature_sigma_k[i] = 0.001F * number;
    cloud.valid[i] = static_cast<std::uint32_t>(1 << (i % 16));
    cloud.utime[i] = kNow + 1000 - 7 * static_cast<Utime>(i);
  }
  const ParsedFrame frame = Parse(CloudFrame(cloud, 0));
  EXPECT_EQ(frame.header.at("utime"), kNow + 300);  // the earliest
  std::set<std::size_t> seen;
  for (const Point& p : PointsOf(frame)) {
    const auto i = static_cast<std::size_t>(p.x);
    seen.insert(i);
    EXPECT_EQ(Eigen::Vector3f(p.x, p.y, p.z), cloud.points[i]);
    EXPECT_EQ(p.red, cloud.rgb[i][0]);
    EXPECT_EQ(p.green, cloud.rgb[i][1]);
    EXPECT_EQ(p.blue, 7);
    EXPECT_EQ(p.intensity, static_cast<int>(i));
    EXPECT_EQ(p.temperature_k, cloud.temperature_k[i]);
    EXPECT_EQ(p.counts, cloud.thermal_counts[i]);
    EXPECT_EQ(p.sigma_mk, static_cast<int>(i));
    EXPECT_EQ(p.valid, 1 << (i % 16));
    EXPECT_EQ(kNow + 300 + p.offset_us, cloud.utime[i]);
  }
  EXPECT_EQ(seen.size(), cloud.size());
}

TEST(CloudFrame, WhatIsUnknownOrTooLargeIsSaidSo) {
  RgbdtCloud cloud = GridCloud(1, 2);
  cloud.intensity = {kNan, 1.7F};
  cloud.temperature_sigma_k = {kNan, 1e9F};
  cloud.utime = {0, kNow};  // further apart than 32 bits hold
  const ParsedFrame frame = Parse(CloudFrame(cloud, 0));
  for (const Point& p : PointsOf(frame)) {
    const bool first = p.y == 0;
    EXPECT_EQ(p.intensity, first ? 255 : 254);
    EXPECT_EQ(p.sigma_mk, first ? 65535 : 65534);
    EXPECT_EQ(p.offset_us, first ? 0 : UINT32_MAX);
    EXPECT_TRUE(std::isnan(p.temperature_k));
    EXPECT_TRUE(std::isnan(p.counts));
  }
}

TEST(CloudFrame, TheHeaderSaysWhatTheCloudIs) {
  RgbdtCloud cloud = GridCloud(2, 3);
  cloud.sweep_utime = kNow;
  cloud.whole_sweep = true;
  cloud.sweep_end = true;
  cloud.cameras = {"rgb", "thermal"};
  cloud.calibration_utime = {kNow, 0};
  const nlohmann::json header = Parse(CloudFrame(cloud, 3)).header;
  EXPECT_EQ(header.at("type"), "cloud");
  EXPECT_EQ(header.at("sweep_utime"), kNow);
  EXPECT_EQ(header.at("whole"), true);
  EXPECT_EQ(header.at("part"), 3);
  EXPECT_EQ(header.at("sweep_end"), true);
  EXPECT_EQ(header.at("cameras"), nlohmann::json({"rgb", "thermal"}));
  EXPECT_EQ(header.at("calibrated"), nlohmann::json({true, false}));
  EXPECT_TRUE(header.at("map_from_lidar").is_null());
  EXPECT_EQ(header.at("count"), 6);
  EXPECT_EQ(header.at("ack"), true);
  cloud.map_from_lidar = Rigid3{Eigen::Quaterniond::Identity(), {4, 5, 6}};
  EXPECT_EQ(Parse(CloudFrame(cloud, 3)).header.at("map_from_lidar").at(7), 5);
}

TEST(CloudFrame, AnEmptyCloudIsAFrameToo) {
  const ParsedFrame frame = Parse(CloudFrame(RgbdtCloud{}, 0));
  EXPECT_EQ(frame.header.at("count"), 0);
  EXPECT_EQ(frame.arrays.at("points"), "");
}

// Chi-square over the degrees of freedom, of how many of the first `count` points fall into each
// of 8 x 8 cells of the grid. By chance it is 1; an even sample stays below.
double Unevenness(const std::vector<Point>& points, std::size_t count, int lines, int beams) {
  constexpr int kCells = 8;
  std::vector<double> found(kCells * kCells, 0), expected(kCells * kCells, 0);
  const auto cell = [&](float line, float beam) {
    const int row = static_cast<int>(line) * kCells / lines;
    return static_cast<std::size_t>(row * kCells + static_cast<int>(beam) * kCells / beams);
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t at = cell(points[i].x, points[i].y);
    found[at] += i < count ? 1 : 0;
    expected[at] += static_cast<double>(count) / static_cast<double>(points.size());
  }
  double chi2 = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    chi2 += (found[i] - expected[i]) * (found[i] - expected[i]) / expected[i];
  }
  return chi2 / (kCells * kCells - 1);
}

TEST(CloudFrame, AnyFirstPartIsAnEvenSample) {
  // Turned scanners, a spinning one of 16 rings, one of 64, and sizes with many divisors.
  for (const auto& [lines, beams] :
       std::vector<std::pair<int, int>>{{96, 400}, {1800, 16}, {900, 64}, {256, 256}, {89, 233}}) {
    const std::vector<Point> points = PointsOf(Parse(CloudFrame(GridCloud(lines, beams), 0)));
    ASSERT_EQ(points.size(), static_cast<std::size_t>(lines * beams));
    for (const double share : {0.05, 0.1, 0.25, 0.5, 0.9}) {
      const auto count = static_cast<std::size_t>(share * static_cast<double>(points.size()));
      EXPECT_LT(Unevenness(points, count, lines, beams), 0.8)
          << lines << " x " << beams << ", first " << count;
    }
  }
}

}  // namespace
}  // namespace rgbdt
