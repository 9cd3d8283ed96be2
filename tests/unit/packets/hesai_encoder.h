#pragma once

// Made-up Hesai packets, by the manuals' tables; none of the driver's code.

#include <cstdint>
#include <string>
#include <vector>

namespace rgbdt::test {

struct HesaiEncoder {
  static constexpr std::int64_t kSecond = 1'700'000'000'000'000;  ///< 2023-11-14 22:13:20
  enum class Model { kXt16, kXt32, kXt32M, k40P, k64, kQt64, kQt128, k128E3X, kOt128 };
  static constexpr Model kAll[] = {Model::kXt16,  Model::kXt32,   Model::kXt32M,
                                   Model::k40P,   Model::k64,     Model::kQt64,
                                   Model::kQt128, Model::k128E3X, Model::kOt128};

  Model model = Model::kXt16;
  bool dual = false;
  bool has_date = true;
  bool high_resolution = false;  ///< of the 128 channels of k128E3X and kOt128
  int near = 1000;               ///< the least range [4 mm]

  int channels() const {
    constexpr int kChannels[] = {16, 32, 32, 40, 64, 64, 128, 128, 128};
    return kChannels[static_cast<int>(model)];
  }
  int blocks() const {
    constexpr int kBlocks[] = {8, 8, 6, 10, 6, 4, 2, 2, 2};
    return kBlocks[static_cast<int>(model)];
  }
  bool IsOld() const { return model == Model::k40P || model == Model::k64; }
  bool Is128() const { return model == Model::k128E3X || model == Model::kOt128; }

  int Range_mm(int azimuth, int channel) const {
    return azimuth == 9000 ? 0 : 4 * (near + azimuth / 100 + 10 * channel);
  }
  // Of a QT128 the first and the second 32 channels take turns; of an OT128 in high resolution
  // pairs of the outer ones. (The E3X's pattern has no rule.)
  bool Fires(int azimuth, int channel) const {
    const bool even = azimuth / 100 % 2 == 0;
    if (model == Model::kQt128) return channel >= 64 || even != (channel < 32);
    const bool outer = channel < 24 || channel >= 88;
    if (model != Model::kOt128 || !high_resolution || !outer) return true;
    return even == (channel % 4 >= 2);
  }
  // Blocks from this azimuth on, 1 degree apart [0.01 degrees].
  std::vector<std::uint8_t> Packet(int first_azimuth, int us) const {
    std::vector<std::uint8_t> bytes = Head();
    for (int block = 0; block < blocks(); ++block) {
      const int azimuth = (first_azimuth + 100 * (dual ? block / 2 : block)) % 36000;
      if (model == Model::k40P) Add(0xeeff, 2, &bytes);
      Add(azimuth, 2, &bytes);
      for (int channel = 0; channel < channels(); ++channel) {
        const bool second = dual && block % 2 == 1;
        const int distance = Range_mm(azimuth, channel) / 4 + (second ? 250 : 0);
        Add(Fires(azimuth, channel) ? distance : 0, 2, &bytes);
        bytes.push_back(second ? 20 : 10);
        if (!IsOld() && model != Model::k128E3X) bytes.push_back(0);
      }
    }
    AddTail(first_azimuth, us, &bytes);
    return bytes;
  }
  static double Elevation_deg(int channel) { return 15 - 0.25 * channel; }
  std::string Angles() const { return Angles(channels()); }
  static std::string Angles(int channels) {
    std::string csv = "Channel,Elevation,Azimuth\n";
    for (int i = 0; i < channels; ++i) {
      csv += std::to_string(i + 1) + "," + std::to_string(Elevation_deg(i)) + "," +
             (i == 1 ? "3" : "0") + "\r\n";
    }
    return csv;
  }

 private:
  static void Add(int value, int count, std::vector<std::uint8_t>* to) {
    for (int i = 0; i < count; ++i) to->push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }
  std::vector<std::uint8_t> Head() const {
    const auto channel_count = static_cast<std::uint8_t>(channels());
    const auto block_count = static_cast<std::uint8_t>(blocks());
    switch (model) {
      case Model::k40P:
        return {};
      case Model::k64:
        return {0xee, 0xff, channel_count, block_count, 0, 4, 0, 0};
      case Model::kQt64:
        return {0xee, 0xff, 3, 1, 0, 0, channel_count, block_count, 1, 4, 2, 1};
      case Model::kQt128:
        return {0xee, 0xff, 3, 2, 3, 0, channel_count, block_count, 0, 4, 2, 0x15};
      case Model::k128E3X:
        return {0xee, 0xff, 1, 4, 3, 0, channel_count, block_count, 0, 4, 2, 0x01};
      case Model::kOt128:
        return {0xee, 0xff, 1, 4, 130, 0, channel_count, block_count, 0, 4, 2, 0x15};
      default:
        return {0xee, 0xff, 6, 1, 0, 0, channel_count, block_count, 0, 4, 2, 0};
    }
  }
  std::vector<std::uint8_t> Date() const {
    const std::uint8_t year = IsOld() ? 23 : 123;
    return {static_cast<std::uint8_t>(has_date ? year : 0), 11, 14, 22, 13, 20};
  }
  void AddTail(int first_azimuth, int us, std::vector<std::uint8_t>* bytes) const {
    const std::uint8_t mode = dual ? 0x39 : 0x37;
    const std::vector<std::uint8_t> date = Date();
    const auto reserve = [&](std::size_t count) { bytes->resize(bytes->size() + count); };
    const int column = first_azimuth / 100;
    if (model == Model::kQt128 || Is128()) {
      reserve(4);                                // a sum
      if (model != Model::k128E3X) reserve(17);  // functional safety
    }
    if (IsOld() || model == Model::kQt64) {
      reserve(model == Model::kQt64 ? 12 : 10);
      Add(us, 4, bytes);
      bytes->push_back(mode);
      bytes->push_back(0x42);
      bytes->insert(bytes->end(), date.begin(), date.end());
      if (model == Model::kQt64) reserve(4);
      return;
    }
    if (model == Model::kQt128) {
      reserve(5);
      bytes->push_back(column % 2 == 0 ? 1 : 0);  // an odd flag: the first loop first
      reserve(6);
    } else if (Is128()) {
      reserve(9);
      const int second = dual ? column : column + 1;
      Add(column % 4 << 14 | second % 4 << 12, 2, bytes);
      bytes->push_back(high_resolution ? 0 : 2);
    } else {
      reserve(10);
    }
    bytes->push_back(mode);
    reserve(2);
    bytes->insert(bytes->end(), date.begin(), date.end());
    Add(us, 4, bytes);
    reserve(1 + 4);
    if (model == Model::kQt128 || Is128()) reserve(4);
  }
};

}  // namespace rgbdt::test
