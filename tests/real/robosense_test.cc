// A RoboSense's recorded packets against a cloud that nebula made of them: of the data set "nebula"
// helios.db3, helios.pcd and helios.csv (nebula_tests/data/robosense/helios16P of its history; the
// LIDAR is a Helios-5515 by its packets). The cloud takes each block's second 16 beams for the
// first 16 lasers again, of which alone the CSV has angles: elevations are compared by it. It has
// the head turn within a block by an earlier table of firing times, which is taken from it: where a
// block begins is compared, when a beam is fired is not.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <sstream>

#include "calib/files/atomic_file.h"
#include "services/bags/bag_reader.h"
#include "services/drivers/robosense/robosense_packets.h"
#include "tests/figures.h"
#include "tests/numbers.h"

namespace rgbdt::robosense {
namespace {

namespace fs = std::filesystem;

// The message is of a type that was never published: its packets are found by their heads.
std::vector<std::string> PacketsIn(const BagMessage& message) {
  std::vector<std::string> packets;
  const std::string bytes(message.data, message.data + message.size);
  for (std::size_t at = 0; at + kPacketBytes <= bytes.size(); ++at) {
    const std::string head = bytes.substr(at, 4);
    if (head != "\x55\xaa\x05\x5a" && head != std::string("\xa5\xff\x00\x5a", 4)) continue;
    packets.push_back(bytes.substr(at, kPacketBytes));
    at += kPacketBytes - 1;
  }
  return packets;
}

// By laser (of 16), distance in units and reflectivity.
using Key = std::tuple<std::size_t, int, int>;

struct Beams {
  const Sensor* sensor = nullptr;
  Angles told;
  std::multimap<Key, int> head;  // where nebula has it when the beam is fired [0.01 degrees]
};

// Of a block's share, cut off to hundredths of a degree.
int TurnedByNebula(int step, std::size_t slot) {
  constexpr double kUs[] = {0,     3.15,  6.30,  9.45,  13.26, 17.08, 20.56, 23.71,
                            26.53, 27.77, 31.49, 32.73, 36.46, 38.94, 41.42, 43.91,
                            55.56, 58.70, 61.85, 65.00, 68.82, 72.64, 76.12, 79.27,
                            82.08, 83.32, 87.05, 88.29, 92.01, 94.50, 96.98, 99.46};
  constexpr double kBlockUs = 2 * 55.56;
  return static_cast<int>(step * kUs[slot] / kBlockUs);
}

const std::uint8_t* Data(const std::string& bytes) {
  return reinterpret_cast<const std::uint8_t*>(bytes.data());
}

void Add(const std::string& bytes, Beams* beams) {
  beams->sensor = SensorOf(Data(bytes), bytes.size());
  ASSERT_NE(beams->sensor, nullptr);
  constexpr int kNominalStep = 20;  // of a packet's last block
  const auto columns = Decode(*beams->sensor, false, Data(bytes), bytes.size()).columns;
  const auto hundredths = [&](std::size_t c) {
    return static_cast<int>(std::lround(columns[c].azimuth_rad / kDegree * 100));
  };
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const int step =
        c + 1 < columns.size() ? (hundredths(c + 1) - hundredths(c) + 36000) % 36000 : kNominalStep;
    for (std::size_t slot = 0; slot < columns[c].returns.size(); ++slot) {
      const Return& back = columns[c].returns[slot];
      const int units = static_cast<int>(std::lround(back.range_m / beams->sensor->unit_m));
      beams->head.insert(
          {{slot % 16, units, back.reflectivity}, hundredths(c) + TurnedByNebula(step, slot)});
    }
  }
}

Beams BeamsOf(const fs::path& path) {
  Beams beams;
  std::string information;
  const auto bag = OpenBag(path);
  BagMessage message;
  while (bag->Next(&message)) {
    for (const std::string& bytes : PacketsIn(message)) {
      IsInformation(Data(bytes), bytes.size()) ? void(information = bytes) : Add(bytes, &beams);
    }
  }
  beams.told = ParseInformation(*beams.sensor, Data(information), information.size()).angles;
  return beams;
}

struct Point {
  Eigen::Vector3d place;
  int reflectivity = 0;
  double azimuth_deg = 0, elevation_deg = 0, range_m = 0;
};

// x y z intensity return_type channel azimuth elevation distance time_stamp; angles in hundredths
// of a degree, times in whole seconds.
std::vector<Point> PointsOf(const fs::path& path) {
  std::vector<Point> points;
  const std::string text = ReadWholeFile(path);
  std::istringstream lines(text.substr(text.find("DATA ascii\n") + 11));
  for (double v[10]; lines >> v[0];) {
    for (int i = 1; i < 10; ++i) lines >> v[i];
    points.push_back({{v[0], v[1], v[2]}, static_cast<int>(v[3]), v[6] / 100, v[7] / 100, v[8]});
  }
  return points;
}

// Angles are whole hundredths of a degree, the points follow by tables of floats.
bool IsThere(const Point& point, const Angles& file, const Beams& beams) {
  constexpr double kFileDeg = 0.0101, kSame = 0.01;  // of a hundredth
  const Sensor& sensor = *beams.sensor;
  const int units = static_cast<int>(std::lround(point.range_m / sensor.unit_m));
  if (std::abs(units * sensor.unit_m - point.range_m) > 1e-6 + 2e-7 * point.range_m) return false;
  for (std::size_t laser = 0; laser < 16; ++laser) {
    if (std::abs(file.elevation_rad[laser] / kDegree - point.elevation_deg) > kFileDeg) continue;
    const double offset_deg = std::round(file.azimuth_rad[laser] / kDegree * 100) / 100;
    const double e = point.elevation_deg * kDegree, a = point.azimuth_deg * kDegree;
    const double head = a - offset_deg * kDegree;
    const Eigen::Vector3d place(
        point.range_m * std::cos(e) * std::cos(a) + sensor.lens.outward_m * std::cos(head),
        -point.range_m * std::cos(e) * std::sin(a) - sensor.lens.outward_m * std::sin(head),
        point.range_m * std::sin(e) + sensor.lens.up_m);
    if ((place - point.place).norm() > 1e-5 + 1e-6 * point.range_m) continue;
    const auto [first, last] = beams.head.equal_range({laser, units, point.reflectivity});
    for (auto beam = first; beam != last; ++beam) {
      const double apart = beam->second - head / kDegree * 100;
      if (std::abs(std::remainder(apart, 36000)) < kSame) return true;
    }
  }
  return false;
}

TEST(NebulaReal, ARobosensesPointsAreThoseOfNebula) {
  const char* data = std::getenv("RGBDT_REAL_DATA");
  const fs::path folder = fs::path(data == nullptr ? "" : data) / "nebula";
  if (!fs::exists(folder / "helios.db3")) {
    GTEST_SKIP() << "no RoboSense of nebula in RGBDT_REAL_DATA: packets not compared";
  }
  const Beams beams = BeamsOf(folder / "helios.db3");
  const Angles file = ParseAngles(ReadWholeFile(folder / "helios.csv"), "helios.csv");
  ASSERT_EQ(beams.sensor->name, "RS-Helios-5515");
  ASSERT_EQ(file.elevation_rad.size(), 16U);
  for (std::size_t laser = 0; laser < 16; ++laser) {
    EXPECT_NEAR(beams.told.elevation_rad[laser], file.elevation_rad[laser], 1e-9) << laser;
    EXPECT_NEAR(beams.told.azimuth_rad[laser], file.azimuth_rad[laser], 0.0101 * kDegree) << laser;
  }
  const std::vector<Point> points = PointsOf(folder / "helios.pcd");
  std::size_t agree = 0;
  for (const Point& point : points) agree += IsThere(point, file, beams) ? 1 : 0;
  ASSERT_GT(points.size(), 10'000U);
  TellShare("robosense_agree", agree, points.size());
  TellFigure("robosense_points", static_cast<double>(points.size()));
  EXPECT_EQ(agree, points.size());
}

}  // namespace
}  // namespace rgbdt::robosense
