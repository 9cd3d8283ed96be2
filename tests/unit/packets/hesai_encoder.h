#pragma once

// Made-up Hesai packets, by the manuals' tables; none of the driver's code.

#include <cstdint>
#include <string>
#include <vector>

namespace rgbdt::test {

struct HesaiEncoder {
  static constexpr std::int64_t kSecond = 1'700'000'000'000'000;  ///< 2023-11-14 22:13:20

  bool is_40p = false;
  int channels = 16;
  bool dual = false;
  bool has_date = true;

  int Range_mm(int azimuth, int channel) const {
    return azimuth == 9000 ? 0 : 4 * (1000 + azimuth / 100 + 10 * channel);
  }
  int blocks() const { return is_40p ? 10 : 8; }
  // Blocks from this azimuth on, 1 degree apart [0.01 degrees].
  std::vector<std::uint8_t> Packet(int first_azimuth, int us) const {
    std::vector<std::uint8_t> bytes;
    if (!is_40p) {
      bytes = {0xee, 0xff, 6, 1, 0, 0, static_cast<std::uint8_t>(channels), 8, 0, 4, 2, 0};
    }
    for (int block = 0; block < blocks(); ++block) {
      const int azimuth = (first_azimuth + 100 * (dual ? block / 2 : block)) % 36000;
      if (is_40p) Add(0xeeff, 2, &bytes);
      Add(azimuth, 2, &bytes);
      for (int channel = 0; channel < channels; ++channel) {
        const bool second = dual && block % 2 == 1;
        Add(Range_mm(azimuth, channel) / 4 + (second ? 250 : 0), 2, &bytes);
        bytes.push_back(second ? 20 : 10);
        if (!is_40p) bytes.push_back(0);
      }
    }
    const std::uint8_t mode = dual ? 0x39 : 0x37;
    const std::uint8_t year = is_40p ? 23 : 123;
    const std::vector<std::uint8_t> date = {
        static_cast<std::uint8_t>(has_date ? year : 0), 11, 14, 22, 13, 20};
    if (is_40p) {
      bytes.resize(bytes.size() + 10);
      Add(us, 4, &bytes);
      bytes.push_back(mode);
      bytes.push_back(0x42);
      bytes.insert(bytes.end(), date.begin(), date.end());
    } else {
      bytes.resize(bytes.size() + 10);
      bytes.push_back(mode);
      bytes.resize(bytes.size() + 2);
      bytes.insert(bytes.end(), date.begin(), date.end());
      Add(us, 4, &bytes);
      bytes.resize(bytes.size() + 1 + 4);
    }
    return bytes;
  }
  std::string Angles() const {
    std::string csv = "Channel,Elevation,Azimuth\n";
    for (int i = 0; i < channels; ++i) {
      csv += std::to_string(i + 1) + "," + std::to_string(15 - i) + "," + (i == 1 ? "3" : "0") +
             "\r\n";
    }
    return csv;
  }

 private:
  static void Add(int value, int count, std::vector<std::uint8_t>* to) {
    for (int i = 0; i < count; ++i) to->push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }
};

}  // namespace rgbdt::test
