// Recorded packets against the clouds that nebula makes of them: the data set "nebula", of its
// decoder_ground_truth: vlp16.db3 (velodyne_msgs/VelodyneScan) and vlp16.pcd.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>

#include "calib/files/atomic_file.h"
#include "services/bags/bag_reader.h"
#include "services/drivers/velodyne/velodyne_packets.h"

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

// CDR, aligned from behind its first four bytes: header, number of packets, stamp and 1206 bytes
// each.
std::vector<std::string> PacketsOf(const BagMessage& message) {
  const std::string bytes(message.data, message.data + message.size);
  const auto align = [](std::size_t at) { return 4 + (at - 4 + 3) / 4 * 4; };
  std::size_t at = align(16 + At<std::uint32_t>(bytes, 12));
  std::vector<std::string> packets(At<std::uint32_t>(bytes, at));
  at += 4;
  for (std::string& packet : packets) {
    at = align(at) + 8;
    packet = bytes.substr(at, velodyne::kDataBytes);
    at += velodyne::kDataBytes;
  }
  return packets;
}

std::multimap<Key, Angles> Decoded(const fs::path& bag_path) {
  const velodyne::Sensor& sensor = velodyne::SensorOf(VelodyneDevice::Model::kVlp16);
  std::multimap<Key, Angles> beams;
  const auto bag = OpenBag(bag_path);
  BagMessage message;
  while (bag->Next(&message)) {
    for (const std::string& bytes : PacketsOf(message)) {
      const velodyne::Packet packet = velodyne::Decode(
          sensor, reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
      for (std::size_t c = 0; c < packet.columns.size(); ++c) {
        const velodyne::Column& column = packet.columns[c];
        for (std::size_t laser = 0; laser < column.returns.size(); ++laser) {
          const velodyne::Return& back = column.returns[laser];
          const double turned =
              column.step_deg * sensor.LaserTime_us(static_cast<int>(laser)) / sensor.column_us;
          // Of a packet's last block nebula takes the azimuth as it stands there.
          const std::size_t last = packet.columns.size() - 2;
          const double azimuth =
              c < last ? column.azimuth_deg + turned : packet.columns[last].azimuth_deg;
          beams.insert({{sensor.ring[laser], back.distance * 2, back.reflectivity},
                        {azimuth, sensor.elevation_deg[laser]}});
        }
      }
    }
  }
  return beams;
}

TEST(NebulaReal, AVelodynesPointsAreThoseOfNebula) {
  const char* data = std::getenv("RGBDT_REAL_DATA");
  const fs::path folder = fs::path(data == nullptr ? "" : data) / "nebula";
  if (data == nullptr || !fs::exists(folder / "vlp16.db3")) {
    GTEST_SKIP() << "no nebula in RGBDT_REAL_DATA: packets not compared";
  }
  const std::multimap<Key, Angles> beams = Decoded(folder / "vlp16.db3");
  // x y z intensity(u8) return_type(u8) channel(u16) azimuth elevation distance time_stamp(u32)
  constexpr std::size_t kPointBytes = 32;
  const std::string bytes = ReadWholeFile(folder / "vlp16.pcd");
  const std::size_t begin = bytes.find("DATA binary\n") + 12;
  std::size_t points = 0, found = 0, near = 0;
  for (std::size_t at = begin; at + kPointBytes <= bytes.size(); at += kPointBytes, ++points) {
    const Key key{At<std::uint16_t>(bytes, at + 14),
                  static_cast<int>(std::lround(1e3F * At<float>(bytes, at + 24))),
                  At<std::uint8_t>(bytes, at + 12)};
    const double azimuth = At<float>(bytes, at + 16) * 180 / M_PI;
    const double elevation = std::asin(At<float>(bytes, at + 20)) * 180 / M_PI;  // its sine
    double nearest = 360;
    bool level = true;
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
  std::printf("velodyne_agree: range, ring, elevation and reflectivity %zu of %zu; azimuth %zu\n",
              found, points, near);
  EXPECT_GT(points, 10'000U);
  // Of a beam's two returns the weaker one is not kept here.
  EXPECT_GT(found, 0.99 * static_cast<double>(points));
  EXPECT_GT(near, 0.98 * static_cast<double>(points));
}

}  // namespace
}  // namespace rgbdt
