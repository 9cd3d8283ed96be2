// Recorded packets against the clouds that nebula makes of them: the data set "nebula", of its
// decoder_ground_truth: NAME.db3 (velodyne_msgs/VelodyneScan, pandar_msgs/PandarScan), NAME.pcd
// and, of a Hesai, NAME.csv, its angles.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <random>

#include "calib/detect/cloud/board_in_cloud.h"
#include "calib/detect/cloud/range_grid.h"
#include "calib/files/atomic_file.h"
#include "services/bags/bag_reader.h"
#include "services/drivers/hesai/hesai_packets.h"
#include "services/drivers/spinning/spinning_sweeps.h"
#include "services/drivers/velodyne/velodyne_packets.h"
#include "tests/figures.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;

template <typename T>
T At(const std::string& bytes, std::size_t at) {
  T value;
  EXPECT_LE(at + sizeof(T), bytes.size());
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

// A beam that returned something, by what stays the same to the bit.
struct Key {
  int ring, distance_mm, reflectivity;
  bool operator<(const Key& b) const {
    return std::tie(ring, distance_mm, reflectivity) <
           std::tie(b.ring, b.distance_mm, b.reflectivity);
  }
};
struct Angles {
  double azimuth_deg, elevation_deg;
};

// CDR, aligned from behind its first four bytes: header, number of packets, and of each its stamp
// and so many bytes; pandar_msgs has their number behind them.
std::vector<std::string> PacketsOf(const BagMessage& message, std::size_t packet_bytes,
                                   bool has_size) {
  const std::string bytes(message.data, message.data + message.size);
  const auto align = [](std::size_t at) { return 4 + (at - 4 + 3) / 4 * 4; };
  std::size_t at = align(16 + At<std::uint32_t>(bytes, 12));
  std::vector<std::string> packets(At<std::uint32_t>(bytes, at));
  at += 4;
  for (std::string& packet : packets) {
    at = align(at) + 8;
    packet = bytes.substr(at, packet_bytes);
    at += packet_bytes;
    if (!has_size) continue;
    at = align(at);
    packet.resize(At<std::uint32_t>(bytes, at));
    at += 4;
  }
  return packets;
}

// To a micrometre, and to what a float has of it.
bool IsRange(double range_m, double expected_m) {
  return std::abs(range_m - expected_m) < 2e-7 * expected_m + 1e-6;
}

fs::path DataFolder() {
  const char* data = std::getenv("RGBDT_REAL_DATA");
  return fs::path(data == nullptr ? "" : data) / "nebula";
}

std::multimap<Key, Angles> Decoded(const fs::path& bag_path) {
  const velodyne::Sensor& sensor = velodyne::SensorOf(VelodyneDevice::Model::kVlp16);
  std::multimap<Key, Angles> beams;
  const auto bag = OpenBag(bag_path);
  BagMessage message;
  while (bag->Next(&message)) {
    for (const std::string& bytes : PacketsOf(message, velodyne::kDataBytes, false)) {
      const velodyne::Packet packet = velodyne::Decode(
          sensor, reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
      for (std::size_t c = 0; c < packet.columns.size(); ++c) {
        const velodyne::Column& column = packet.columns[c];
        for (std::size_t laser = 0; laser < column.returns.size(); ++laser) {
          const double turned =
              column.step_deg * sensor.LaserTime_us(static_cast<int>(laser)) / sensor.column_us;
          // Of a packet's last block nebula takes the azimuth as it stands there.
          const std::size_t last = packet.columns.size() - 2;
          const double azimuth =
              c < last ? column.azimuth_deg + turned : packet.columns[last].azimuth_deg;
          for (const auto* returns : {&column.returns, &column.second_returns}) {
            if (returns->empty()) continue;
            const velodyne::Return& back = (*returns)[laser];
            beams.insert({{sensor.ring[laser], back.distance * 2, back.reflectivity},
                          {azimuth, sensor.elevation_deg[laser]}});
          }
        }
      }
    }
  }
  return beams;
}

TEST(NebulaReal, AVelodynesPointsAreThoseOfNebula) {
  const fs::path folder = DataFolder();
  if (!fs::exists(folder / "vlp16.db3")) {
    GTEST_SKIP() << "no nebula in RGBDT_REAL_DATA: packets not compared";
  }
  const std::multimap<Key, Angles> beams = Decoded(folder / "vlp16.db3");
  // x y z intensity(u8) return_type(u8) channel(u16) azimuth elevation distance time_stamp(u32)
  constexpr std::size_t kPointBytes = 32;
  const std::string bytes = ReadWholeFile(folder / "vlp16.pcd");
  const std::size_t begin = bytes.find("DATA binary\n") + 12;
  std::size_t points = 0, found = 0, near = 0;
  for (std::size_t at = begin; at + kPointBytes <= bytes.size(); at += kPointBytes, ++points) {
    const double range = At<float>(bytes, at + 24);
    const Key key{At<std::uint16_t>(bytes, at + 14), static_cast<int>(std::lround(1e3 * range)),
                  At<std::uint8_t>(bytes, at + 12)};
    const double azimuth = At<float>(bytes, at + 16) * 180 / M_PI;
    const double elevation = std::asin(At<float>(bytes, at + 20)) * 180 / M_PI;  // its sine
    double nearest = 360;
    bool level = IsRange(1e-3 * key.distance_mm, range);
    const auto [first, last] = beams.equal_range(key);
    for (auto beam = first; beam != last; ++beam) {
      level &= std::abs(beam->second.elevation_deg - elevation) < 1e-3;
      nearest =
          std::min(nearest, std::abs(std::remainder(beam->second.azimuth_deg - azimuth, 360)));
    }
    if (first != last && level) ++found;
    // nebula rounds to 0.01 degrees.
    if (nearest < 0.006) ++near;
  }
  ASSERT_GT(points, 10'000U);
  TellShare("velodyne_agree", found, points);  // range, ring, elevation and reflectivity
  TellShare("velodyne_azimuth_agree", near, points);
  TellFigure("velodyne_points", static_cast<double>(points));
  EXPECT_EQ(found, points);
  EXPECT_GT(near, 0.98 * static_cast<double>(points));
}

// Each return of a Hesai, by channel and distance [mm], which is whole: its azimuth [rad].
using HesaiBeams = std::multimap<std::pair<std::size_t, std::int64_t>, double>;

HesaiBeams DecodedHesai(const fs::path& bag_path, const hesai::Angles& angles) {
  HesaiBeams beams;
  const auto bag = OpenBag(bag_path);
  BagMessage message;
  while (bag->Next(&message)) {
    for (const std::string& bytes : PacketsOf(message, 1500, true)) {
      const auto* data = reinterpret_cast<const std::uint8_t*>(bytes.data());
      const hesai::Sensor* sensor = hesai::SensorOf(data, bytes.size());
      EXPECT_TRUE(sensor != nullptr && sensor->channels == angles.azimuth_rad.size()) << bag_path;
      if (sensor == nullptr || sensor->channels != angles.azimuth_rad.size()) return beams;
      for (const hesai::Column& column : hesai::Decode(*sensor, data, bytes.size()).columns) {
        for (const auto* returns : {&column.returns, &column.second_returns}) {
          for (std::size_t channel = 0; channel < returns->size(); ++channel) {
            if (!std::isfinite((*returns)[channel].after_us)) continue;  // it is said not to fire
            beams.insert({{channel, std::lround((*returns)[channel].range_m * 1e3)},
                          column.azimuth_rad + angles.azimuth_rad[channel]});
          }
        }
      }
    }
  }
  return beams;
}

// Channels may look equally high.
bool IsThere(const Eigen::Vector3d& p, const hesai::Angles& angles, const HesaiBeams& beams) {
  constexpr double kNearRad = 1e-5;
  const double elevation = std::asin(p.z() / p.norm()), azimuth = std::atan2(p.x(), p.y());
  const std::int64_t mm = std::lround(p.norm() * 1e3);
  if (!IsRange(1e-3 * static_cast<double>(mm), p.norm())) return false;
  for (std::size_t channel = 0; channel < angles.elevation_rad.size(); ++channel) {
    if (std::abs(angles.elevation_rad[channel] - elevation) > kNearRad) continue;
    const auto [first, last] = beams.equal_range({channel, mm});
    for (auto beam = first; beam != last; ++beam) {
      if (std::abs(std::remainder(beam->second - azimuth, 2 * M_PI)) < kNearRad) return true;
    }
  }
  return false;
}

TEST(NebulaReal, AHesaisPointsAreThoseOfNebula) {
  const fs::path folder = DataFolder();
  std::size_t points = 0, agree = 0;
  for (const std::string name : {"40p", "64", "qt64", "qt128", "ot128", "xt32", "xt32m", "xt16"}) {
    if (!fs::exists(folder / (name + ".db3"))) continue;
    const hesai::Angles angles = hesai::ParseAngles(ReadWholeFile(folder / (name + ".csv")), name);
    const HesaiBeams beams = DecodedHesai(folder / (name + ".db3"), angles);
    const std::string bytes = ReadWholeFile(folder / (name + ".pcd"));
    constexpr std::size_t kStride = 12;
    std::size_t those = 0, there = 0;
    for (std::size_t at = bytes.find("DATA binary\n") + 12; at + kStride <= bytes.size();
         at += kStride, ++those) {
      const Eigen::Vector3d p(At<float>(bytes, at), At<float>(bytes, at + 4),
                              At<float>(bytes, at + 8));
      if (IsThere(p, angles, beams)) ++there;
    }
    EXPECT_EQ(there, those) << name;
    points += those;
    agree += there;
  }
  if (points == 0) GTEST_SKIP() << "no nebula in RGBDT_REAL_DATA: packets not compared";
  TellShare("hesai_agree", agree, points);
  TellFigure("hesai_points", static_cast<double>(points));
}

// Its rings below 8 degrees fire in turn.
std::vector<Cloud> SweepsOfQt128(const fs::path& folder) {
  SpinningSweeps sweeps(hesai::ParseAngles(ReadWholeFile(folder / "qt128.csv"), "qt128.csv"));
  std::vector<Cloud> clouds;
  const auto bag = OpenBag(folder / "qt128.db3");
  BagMessage message;
  while (bag->Next(&message)) {
    for (const std::string& bytes : PacketsOf(message, 1500, true)) {
      const auto* data = reinterpret_cast<const std::uint8_t*>(bytes.data());
      const hesai::Packet packet =
          hesai::Decode(*hesai::SensorOf(data, bytes.size()), data, bytes.size());
      for (Cloud& cloud : sweeps.Add(packet, 0)) clouds.push_back(std::move(cloud));
    }
  }
  return clouds;
}

constexpr double kImplantSigmaM = 0.008;

// The sweep as if a board stood there, and nothing before it, touching it or beside it.
Cloud WithBoard(Cloud cloud, const Target& target, const Rigid3& lidar_from_target,
                std::mt19937* random) {
  constexpr double kClear = 0.3, kMargin = 0.2;
  std::normal_distribution<double> noise(0, kImplantSigmaM);
  const Rigid3 target_from_lidar = lidar_from_target.Inverse();
  const Eigen::Vector3d eye = target_from_lidar.translation;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.directions[i].allFinite()) continue;
    const Eigen::Vector3d ray = cloud.directions[i].cast<double>();
    const double range = -eye.z() / (target_from_lidar.rotation * ray).z();
    if (!(range > 0)) continue;
    const Eigen::Vector3d on = target_from_lidar * Eigen::Vector3d(range * ray);
    const double beyond =
        std::max(std::abs(on.x()) - target.width_m / 2, std::abs(on.y()) - target.height_m / 2);
    if (beyond > kMargin) continue;
    if (cloud.points[i].norm() < range + kClear) cloud.points[i].setConstant(NAN);
    if (beyond < 0) cloud.points[i] = ((range + noise(*random)) * ray).cast<float>();
  }
  return cloud;
}

TEST(NebulaReal, ABoardAmongTheRingsOfAQt128ThatFireInTurnIsFound) {
  const fs::path folder = DataFolder();
  if (!fs::exists(folder / "qt128.db3")) GTEST_SKIP() << "no nebula's qt128 in RGBDT_REAL_DATA";
  const std::vector<Cloud> clouds = SweepsOfQt128(folder);
  ASSERT_FALSE(clouds.empty());
  const RangeGrid grid(clouds[0]);
  EXPECT_EQ(grid.firing_columns(), 2);
  const Target target{9, 6, 0.1, 1.2, 0.9, {0, 0}, {}};
  BoardInCloudOptions options;
  options.range_sigma_m = kImplantSigmaM;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> lean(-0.4, 0.4);
  constexpr int kBoards = 60;
  int found = 0;
  double chi2 = 0;
  for (int k = 0; k < kBoards; ++k) {
    const double azimuth = 0.1 * k, elevation = (k % 5 - 3) * 0.17, range = 2 + k % 3;
    Eigen::Matrix3d facing;  // x to the right, y down, z away from the LIDAR
    facing << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    const Rigid3 there = RotationAbout({0, 0, 1}, azimuth) * RotationAbout({0, 1, 0}, -elevation);
    const Rigid3 board = there * Rigid3{Eigen::Quaterniond(facing), {range, 0, 0}} *
                         RotationAbout({1, 0, 0}, lean(random)) *
                         RotationAbout({0, 1, 0}, lean(random)) *
                         RotationAbout({0, 0, 1}, 4 * lean(random));
    const BoardsInCloud boards =
        FindBoards(WithBoard(clouds[0], target, board, &random), target, options);
    if (boards.candidates.empty()) continue;
    const TargetPose& pose = *boards.candidates[0].pose;
    if ((pose.sensor_from_target.translation - board.translation).norm() > 0.1) continue;
    ++found;
    const Rigid3 turned = board * RotationAbout({0, 0, 1}, M_PI);
    const bool half = RotationDistance(pose.sensor_from_target, turned) <
                      RotationDistance(pose.sensor_from_target, board);
    const Vector6d error = Log((half ? turned : board) * pose.sensor_from_target.Inverse());
    chi2 += error.dot(pose.covariance.ldlt().solve(error));
  }
  TellShare("qt128_boards_found", static_cast<std::size_t>(found), kBoards);
  TellFigure("qt128_boards_chi2", chi2 / found);
  EXPECT_GE(found, kBoards - 1);
  // Six degrees of freedom; the mean of 60 has sigma sqrt(12 / 60) = 0.45.
  EXPECT_LT(chi2 / found, 6 + 3 * 0.45);
}

}  // namespace
}  // namespace rgbdt
