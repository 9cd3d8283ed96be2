#pragma once

// Made-up RoboSense packets, by the manuals' tables; none of the driver's code.

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace rgbdt::test {

struct RobosenseEncoder {
  static constexpr std::int64_t kSecond = 1'700'000'000'000'000;  ///< 2023-11-14 22:13:20
  enum class Model { kRs16, kRs32, kBpearl, kBpearl4, kHelios };
  static constexpr Model kAll[] = {Model::kRs16, Model::kRs32, Model::kBpearl, Model::kBpearl4,
                                   Model::kHelios};

  Model model = Model::kRs16;
  bool dual = false;
  bool has_date = true;

  int channels() const { return model == Model::kRs16 ? 16 : 32; }
  // Of a block; a RS-16's has two firings of one return, half a step apart.
  int columns() const { return model == Model::kRs16 ? (dual ? 12 : 24) : (dual ? 6 : 12); }
  // From block to block of one return, and between the two firings of a RS-16 [us].
  double block_us() const {
    constexpr double kUs[] = {111, 55.52, 55.52, 55.56, 55.56};
    return kUs[static_cast<int>(model)];
  }
  double packet_us() const { return 12 * block_us() * (dual ? 0.5 : 1); }
  bool IsFine() const { return model == Model::kBpearl4 || model == Model::kHelios; }
  double unit_m() const { return IsFine() ? 0.0025 : 0.005; }
  static constexpr int kStep = 100;  ///< from block to block of another firing [0.01 degrees]

  // In units, of the block's azimuth and the slot's place in it.
  int Distance(int azimuth, int slot) const {
    return azimuth == 9000 ? 0 : 400 + azimuth / 100 + 10 * slot;
  }
  // Of what the manual calls a channel.
  double Elevation_deg(int channel) const {
    return model == Model::kRs16 ? (channel < 8 ? -15 + 2 * channel : 15 - 2 * (channel - 8))
                                 : 15 - 1.5 * channel;
  }
  double Azimuth_deg(int channel) const {
    return model == Model::kRs16 ? 0 : (channel % 2 == 0 ? -4 : 3.5);
  }

  // Blocks from this azimuth on.
  std::vector<std::uint8_t> Packet(int first_azimuth, int us) const {
    std::vector<std::uint8_t> bytes = {0x55, 0xaa, 0x05, 0x0a, 0x5a, 0xa5, 0x50, 0xa0};
    if (model == Model::kHelios) bytes = {0x55, 0xaa, 0x05, 0x5a, 0, 1, 0, 0};
    bytes.resize(20);
    AddTime(us, &bytes);
    constexpr std::uint8_t kModels[] = {1, 2, 3, 3, 6};
    bytes.push_back(kModels[static_cast<int>(model)]);
    bytes.push_back(model == Model::kBpearl4 ? 3 : 0);
    bytes.push_back(model == Model::kBpearl4 ? 4 : 0);
    bytes.resize(42);
    for (int block = 0; block < 12; ++block) {
      const bool pairs = dual && model != Model::kRs16;
      const int azimuth = (first_azimuth + kStep * (pairs ? block / 2 : block)) % 36000;
      Add(0xffee, 2, &bytes);
      Add(azimuth, 2, &bytes);
      for (int slot = 0; slot < 32; ++slot) {
        const bool again = dual && (pairs ? block % 2 == 1 : slot >= 16);
        const int place = dual && !pairs ? slot % 16 : slot;
        Add(Distance(azimuth, place) + (again && azimuth != 9000 ? 200 : 0), 2, &bytes);
        bytes.push_back(again ? 20 : 10);
      }
    }
    bytes.resize(1248);
    return bytes;
  }
  std::vector<std::uint8_t> Information() const {
    std::vector<std::uint8_t> bytes = {0xa5, 0xff, 0x00, 0x5a, 0x11, 0x11, 0x55, 0x55};
    bytes.resize(300);
    bytes.push_back(dual ? 0 : model == Model::kHelios ? 4 : 1);
    if (model == Model::kRs16) {
      bytes.resize(1165);
      for (int i = 0; i < 16; ++i) {
        Add(static_cast<int>(std::lround(1e4 * std::abs(Elevation_deg(i)))), 3, &bytes);
      }
    } else {
      bytes.resize(468);
      const double per_degree = model == Model::kRs32 ? 1000 : 100;
      for (int i = 0; i < 32; ++i) AddAngle(Elevation_deg(i) * per_degree, &bytes);
      for (int i = 0; i < 32; ++i) AddAngle(Azimuth_deg(i) * per_degree, &bytes);
    }
    bytes.resize(1248);
    return bytes;
  }
  std::string Angles() const {
    std::string csv;
    for (int i = 0; i < channels(); ++i) {
      csv += std::to_string(Elevation_deg(i)) + "," + std::to_string(Azimuth_deg(i)) + "\r\n";
    }
    return csv;
  }

 private:
  static void Add(std::int64_t value, int count, std::vector<std::uint8_t>* to) {
    for (int i = count; i-- > 0;) to->push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }
  static void AddAngle(double value, std::vector<std::uint8_t>* to) {
    to->push_back(value < 0 ? 1 : 0);
    Add(std::lround(std::abs(value)), 2, to);
  }
  void AddTime(int us, std::vector<std::uint8_t>* to) const {
    if (IsFine()) {
      Add(has_date ? kSecond / 1'000'000 : 77, 6, to);
      Add(us, 4, to);
      return;
    }
    for (const int part : {has_date ? 23 : 0, 11, 14, 22, 13, 20}) Add(part, 1, to);
    Add(us / 1000, 2, to);
    Add(us % 1000, 2, to);
  }
};

}  // namespace rgbdt::test
