#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace rgbdt {

/// What a made-up spinning LIDAR sees: distance [m] (0: nothing returned) and reflectivity (0 to
/// 255) at an elevation and an azimuth [degrees, clockwise from above].
struct VelodyneScene {
  std::function<double(double elevation_deg, double azimuth_deg)> distance;
  std::function<int(double elevation_deg, double azimuth_deg)> reflectivity;
};

/// A made-up sensor, by the tables of its manual; none of the driver's code.
struct VelodyneEncoder {
  enum class Model { kVlp16, kVlp32c, kHdl32e, kHdl64e };
  Model model = Model::kVlp16;
  int block_turn = 40;    ///< from block to block [0.01 degrees], HDL-64E: pair to pair
  bool dual = false;      ///< every block twice, the second one's distances a metre longer
  int first_azimuth = 0;  ///< [0.01 degrees]
  std::uint32_t first_stamp_us = 0;
  VelodyneScene scene;

  /// The packet of this number, 0, 1, ...
  std::vector<std::uint8_t> Packet(int number) const;
  double PacketDuration_us() const;
  int PacketsPerTurn() const;
  double Elevation(int laser) const;
  /// The azimuth a laser has while its block's is `block_deg` [degrees]; `column`: VLP-16, 0 or 1.
  double Azimuth(int laser, int column, double block_deg) const;
  int lasers() const;

 private:
  double LaserTime_us(int laser) const;
  double BlockTime_us() const;
};

/// A scene of some metres with nothing between 30 and 40 degrees.
double MadeUpDistance(double elevation_deg, double azimuth_deg);
int MadeUpReflectivity(double elevation_deg, double azimuth_deg);
/// A sensor in it that turns ten times a second or so, first seen at 90 degrees, 0.1 s before the
/// hour.
VelodyneEncoder MadeUpVelodyne(VelodyneEncoder::Model model);

/// Writes a recording of UDP datagrams.
struct PcapWriter {
  enum class Link { kEthernet, kVlan, kCooked, kRaw };
  Link link = Link::kEthernet;
  bool next_generation = false;  ///< pcapng
  int port = 2368;
  std::array<std::uint8_t, 4> from = {192, 168, 1, 201};
  std::string bytes;

  void Begin();
  void Add(std::int64_t utime, const std::vector<std::uint8_t>& payload,
           std::size_t captured = 100'000);
  void Save(const std::string& path) const;
};

}  // namespace rgbdt
