// Recorded packets of Ouster sensors against what Ouster's own SDK makes of them. The data set
// "ouster": NAME.pcap, NAME.json (metadata) and NAME_digest.json (MD5 of each field of all packets)
// of the SDK's tests/pcaps.
#include <glib.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "calib/files/atomic_file.h"
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

}  // namespace
}  // namespace rgbdt
