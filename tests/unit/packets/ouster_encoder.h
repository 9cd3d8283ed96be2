#pragma once

// Made-up Ouster packets, by the manual's tables; none of the driver's code.

#include <cmath>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace rgbdt::test {

struct OusterEncoder {
  std::string profile = "LEGACY";
  int rows = 4, columns = 32, columns_per_packet = 16;
  bool nested = false;  ///< the metadata of firmware 3
  std::vector<int> shifts = {2, 1, 0, -1};
  std::vector<double> altitude_deg = {10, 3, -4, -11}, azimuth_deg = {4, 2, 0, -2};
  double beam_origin_mm = 15.8, height_mm = 36;
  std::int64_t first_ns = 1'000'000'000;
  std::function<int(int row, int column)> range_mm = [](int row, int column) {
    return column == 5 ? 0 : 8 * (1000 + 100 * row + column);
  };

  std::int64_t TimeNs(int frame, int column) const {
    return first_ns + (std::int64_t{frame} * columns + column) * 97'000;
  }
  int Reflectivity(int row, int column) const { return (10 * row + column) % 256; }

  std::string Metadata() const {
    nlohmann::json format = {{"columns_per_frame", columns},
                             {"columns_per_packet", columns_per_packet},
                             {"pixels_per_column", rows},
                             {"pixel_shift_by_row", shifts},
                             {"udp_profile_lidar", profile}};
    nlohmann::json beams = {{"beam_altitude_angles", altitude_deg},
                            {"beam_azimuth_angles", azimuth_deg},
                            {"lidar_origin_to_beam_origin_mm", beam_origin_mm}};
    const nlohmann::json lidar = {
        {"lidar_to_sensor_transform", {-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, height_mm, 0, 0, 0, 1}}};
    nlohmann::json all;
    if (nested) {
      all = {{"lidar_data_format", format},
             {"beam_intrinsics", beams},
             {"lidar_intrinsics", lidar},
             {"sensor_info", {{"prod_line", "OS-0-4"}}}};
    } else {
      if (profile == "LEGACY") format.erase("udp_profile_lidar");
      all = {{"data_format", format}, {"prod_line", "OS-0-4"}};
      all.update(beams);
      all.update(lidar);
    }
    return all.dump();
  }

  std::vector<std::uint8_t> Packet(int frame, int number) const {
    const bool legacy = profile == "LEGACY";
    std::vector<std::uint8_t> bytes;
    if (!legacy) {
      Add(1, 2, &bytes);  // of the lidar
      Add(frame, 2, &bytes);
      bytes.resize(32);
    }
    for (int i = 0; i < columns_per_packet; ++i) {
      const int column = number * columns_per_packet + i;
      Add(TimeNs(frame, column), 8, &bytes);
      Add(column, 2, &bytes);
      Add(legacy ? frame : 1, 2, &bytes);  // or the status
      if (legacy) Add(88 * column, 4, &bytes);
      for (int row = 0; row < rows; ++row) AddBeam(row, column, &bytes);
      if (legacy) Add(0xffffffff, 4, &bytes);
    }
    if (!legacy) bytes.resize(bytes.size() + 32);
    return bytes;
  }

 private:
  static void Add(std::int64_t value, int count, std::vector<std::uint8_t>* to) {
    for (int i = 0; i < count; ++i) to->push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }
  void AddBeam(int row, int column, std::vector<std::uint8_t>* to) const {
    const int range = range_mm(row, column), reflectivity = Reflectivity(row, column);
    if (profile == "RNG15_RFL8_NIR8") {
      Add(range / 8 | 0x8000, 2, to);  // a flag above the range
      Add(reflectivity, 1, to);
      Add(77, 1, to);
    } else if (profile == "RNG19_RFL8_SIG16_NIR16_DUAL") {
      Add(range | 3 << 19, 3, to);
      Add(reflectivity, 1, to);
      Add(range + 1000, 3, to);
      Add(99, 1, to);
      Add(0, 8, to);
    } else {
      Add(range | (profile == "LEGACY" ? 1 << 28 : 5 << 19), 4, to);
      Add(reflectivity, 1, to);
      Add(0, 7, to);
    }
  }
};

}  // namespace rgbdt::test
