// Recorded packets of Ouster sensors against what Ouster's own SDK makes of them. The data set
// "ouster": NAME.pcap, NAME.json (metadata) and NAME_digest.json (MD5 of each field of all packets)
// of the SDK's tests/pcaps; and OS-1-128_v2.3.0_1024x10_lb_n3.pcap of there, its metadata
// OS-1-128_v2.3.0_1024x10.json, and the map that the SDK made of it, tests/osfs'
// OS-1-128_v2.3.0_1024x10_lb_n3_map-000.ply.
#include <glib.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "calib/files/atomic_file.h"
#include "calib/files/points/cloud_files.h"
#include "services/drivers/ouster/ouster_packets.h"
#include "services/drivers/pcap/pcap_reader.h"
#include "services/packets/recording.h"
#include "tests/figures.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// The digests' fields, as the SDK lays each packet's out: beams row by row.
class Fields {
 public:
  void Add(const ouster::Metadata& metadata, const ouster::Packet& packet) {
    for (const ouster::Column& column : packet.columns) {
      Append(static_cast<std::uint64_t>(column.time_ns), &bytes_["TIMESTAMP"]);
      Append(static_cast<std::uint16_t>(column.measurement), &bytes_["MEASUREMENT_ID"]);
    }
    for (std::size_t row = 0; row < static_cast<std::size_t>(metadata.rows); ++row) {
      for (const ouster::Column& column : packet.columns) {
        Append(column.returns[row].range_mm, &bytes_["RANGE"]);
        Append(column.returns[row].reflectivity, &bytes_["REFLECTIVITY"]);
        if (!column.second_returns.empty()) {
          Append(column.second_returns[row].range_mm, &bytes_["RANGE2"]);
          Append(column.second_returns[row].reflectivity, &bytes_["REFLECTIVITY2"]);
        }
        ++points_;
      }
    }
  }
  std::string Md5(const std::string& field) const {
    const std::string& bytes = bytes_.at(field);
    char* text = g_compute_checksum_for_data(
        G_CHECKSUM_MD5, reinterpret_cast<const guchar*>(bytes.data()), bytes.size());
    std::string digest = text;
    g_free(text);
    return digest;
  }
  std::size_t points() const { return points_; }

 private:
  template <typename T>
  static void Append(T value, std::string* to) {
    to->append(reinterpret_cast<const char*>(&value), sizeof(value));
  }
  std::map<std::string, std::string> bytes_;
  std::size_t points_ = 0;
};

TEST(OusterReal, EveryFieldIsThatOfTheSensorsOwnSoftware) {
  const char* data = std::getenv("RGBDT_REAL_DATA");
  const fs::path folder = fs::path(data == nullptr ? "" : data) / "ouster";
  if (data == nullptr || !fs::is_directory(folder)) {
    GTEST_SKIP() << "no ouster in RGBDT_REAL_DATA: packets not compared";
  }
  const std::string kEnd = "_digest.json";
  std::size_t recordings = 0, points = 0, agree = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    std::string name = entry.path().filename().string();
    if (name.size() < kEnd.size() || name.substr(name.size() - kEnd.size()) != kEnd) continue;
    name.erase(name.size() - kEnd.size());
    const json expected = json::parse(ReadWholeFile(entry.path())).at("packet_hash");
    const fs::path json_path = folder / (name + ".json");
    const ouster::Metadata metadata =
        ouster::ParseMetadata(ReadWholeFile(json_path), json_path.string());
    PcapReader recording((folder / (name + ".pcap")).string());
    Fields fields;
    while (const auto datagram = recording.Next()) {
      if (datagram->payload.size() != metadata.PacketBytes()) continue;  // of the IMU
      fields.Add(metadata,
                 ouster::Decode(metadata, datagram->payload.data(), datagram->payload.size()));
    }
    bool same = true;
    for (const char* field :
         {"RANGE", "REFLECTIVITY", "TIMESTAMP", "MEASUREMENT_ID", "RANGE2", "REFLECTIVITY2"}) {
      if (!expected.contains(field)) continue;
      EXPECT_EQ(fields.Md5(field), expected.at(field)) << name << " " << field;
      same &= fields.Md5(field) == expected.at(field);
    }
    points += fields.points();
    // A digest tells of all points of a recording or of none.
    if (same) agree += fields.points();
    ++recordings;
  }
  ASSERT_GT(points, 0U);
  TellShare("ouster_agree", agree, points);
  TellFigure("ouster_points", static_cast<double>(points));
  TellFigure("ouster_recordings", static_cast<double>(recordings));
}

constexpr const char* kMapped = "OS-1-128_v2.3.0_1024x10_lb_n3";

// The recording of which there is a map; nothing where it is not there.
std::optional<fs::path> MappedFolder() {
  const char* data = std::getenv("RGBDT_REAL_DATA");
  const fs::path folder = fs::path(data == nullptr ? "" : data) / "ouster";
  if (data == nullptr || !fs::exists(folder / (std::string(kMapped) + "_map-000.ply"))) {
    return std::nullopt;
  }
  return folder;
}

// Points by the cells of a grid that they are in.
class Grid {
 public:
  explicit Grid(double cell_m) : cell_m_(cell_m) {}
  void Add(const Eigen::Vector3f& point) { cells_[CellOf(point)].push_back(point); }
  std::size_t CountAt(const Eigen::Vector3f& point) const {
    const auto found = cells_.find(CellOf(point));
    return found == cells_.end() ? 0 : found->second.size();
  }
  // [m]; infinite: none is in this cell or one beside it
  double NearestTo(const Eigen::Vector3f& point) const {
    double nearest = std::numeric_limits<double>::infinity();
    const Cell middle = CellOf(point);
    for (int i = 0; i < 27; ++i) {
      const Cell cell = {middle[0] + i % 3 - 1, middle[1] + i / 3 % 3 - 1, middle[2] + i / 9 - 1};
      const auto found = cells_.find(cell);
      if (found == cells_.end()) continue;
      for (const Eigen::Vector3f& other : found->second) {
        nearest = std::min(nearest, (other - point).cast<double>().norm());
      }
    }
    return nearest;
  }

 private:
  using Cell = std::array<int, 3>;
  Cell CellOf(const Eigen::Vector3f& point) const {
    const auto floor = [&](float x) { return static_cast<int>(std::floor(x / cell_m_)); };
    return {floor(point.x()), floor(point.y()), floor(point.z())};
  }
  double cell_m_;
  std::map<Cell, std::vector<Eigen::Vector3f>> cells_;
};

// The map has the mean of the points in each 0.1 m, in the first sweep's frame. Of a point that is
// alone there in the first sweep, the mean is itself, or, with points of the other two, farther off
// than 1 mm: so what lies within 1 mm is to be where the SDK has it, its direction included.
TEST(OusterReal, PointsAreWhereTheSensorsOwnSoftwareHasThem) {
  const auto folder = MappedFolder();
  if (!folder) GTEST_SKIP() << "no " << kMapped << " in RGBDT_REAL_DATA: points not compared";
  Grid map(0.005), sweep(0.1);
  const std::string name = kMapped;
  for (const Eigen::Vector3f& point : ReadFused(*folder / (name + "_map-000.ply")).points) {
    map.Add(point);
  }
  std::optional<Cloud> first;
  ReadRecording(*folder / (name + ".pcap"), {*folder / "OS-1-128_v2.3.0_1024x10.json", 0},
                [&](const Cloud& cloud) {
                  if (!first) first = cloud;
                });
  ASSERT_TRUE(first);
  for (std::size_t i = 0; i < first->size(); ++i) {
    if (first->IsHit(i)) sweep.Add(first->points[i]);
  }
  constexpr double kPairedM = 1e-3, kAgreeRad = 10e-6;
  std::set<std::size_t> rows, columns;
  std::size_t paired = 0, agree = 0;
  double farthest_rad = 0;
  for (std::size_t i = 0; i < first->size(); ++i) {
    if (!first->IsHit(i) || sweep.CountAt(first->points[i]) != 1) continue;
    const double off_m = map.NearestTo(first->points[i]);
    if (off_m > kPairedM) continue;
    const double off_rad = off_m / first->points[i].cast<double>().norm();
    farthest_rad = std::max(farthest_rad, off_rad);
    ++paired;
    if (off_rad > kAgreeRad) continue;
    ++agree;
    rows.insert(i / static_cast<std::size_t>(first->beams));
    columns.insert(i % static_cast<std::size_t>(first->beams));
  }
  EXPECT_GT(paired, 40'000U);
  EXPECT_EQ(agree, paired) << "farthest: " << 1e6 * farthest_rad << " urad";
  EXPECT_EQ(rows.size(), 128U);
  EXPECT_EQ(columns.size(), 1024U);
  TellShare("ouster_direction_agree", agree, paired);
  TellFigure("ouster_directions", static_cast<double>(paired));
  TellFigure("ouster_direction_urad", 1e6 * farthest_rad, "urad");
}

// Of a column of which the digests hold the time, each point of the sweep has that, from the
// sweep's first column on.
TEST(OusterReal, EachPointHasItsColumnsTime) {
  const auto folder = MappedFolder();
  if (!folder) GTEST_SKIP() << "no " << kMapped << " in RGBDT_REAL_DATA: times not compared";
  const fs::path json_path = *folder / "OS-1-128_v2.3.0_1024x10.json";
  const fs::path pcap_path = *folder / (std::string(kMapped) + ".pcap");
  const ouster::Metadata metadata =
      ouster::ParseMetadata(ReadWholeFile(json_path), json_path.string());
  const int columns = metadata.columns_per_frame;
  std::vector<std::vector<std::int64_t>> time_ns;  // of each turn, by column
  PcapReader recording(pcap_path.string());
  std::optional<int> turn;
  while (const auto datagram = recording.Next()) {
    if (datagram->payload.size() != metadata.PacketBytes()) continue;
    const auto packet =
        ouster::Decode(metadata, datagram->payload.data(), datagram->payload.size());
    if (turn != packet.frame) time_ns.emplace_back(static_cast<std::size_t>(columns), 0);
    turn = packet.frame;
    for (const ouster::Column& column : packet.columns) {
      time_ns.back()[static_cast<std::size_t>(column.measurement)] = column.time_ns;
    }
  }
  std::size_t sweeps = 0;
  double farthest_us = 0;
  ReadRecording(pcap_path, {json_path, 0}, [&](const Cloud& sweep) {
    ASSERT_LT(sweeps, time_ns.size());
    const std::vector<std::int64_t>& expected = time_ns[sweeps++];
    for (std::size_t i = 0; i < sweep.size(); ++i) {
      const int line = static_cast<int>(i) / columns, beam = static_cast<int>(i) % columns;
      const int shift = metadata.pixel_shift[static_cast<std::size_t>(sweep.lines - 1 - line)];
      const auto column = static_cast<std::size_t>(((beam - shift) % columns + columns) % columns);
      const double since_us = 1e-3 * static_cast<double>(expected[column] - expected[0]);
      farthest_us =
          std::max(farthest_us,
                   std::abs(static_cast<double>(sweep.utime[i] - sweep.sweep_utime) - since_us));
    }
  });
  EXPECT_EQ(sweeps, time_ns.size());
  EXPECT_LE(farthest_us, 1);
  TellFigure("ouster_time_us", farthest_us, "us");
}

}  // namespace
}  // namespace rgbdt
