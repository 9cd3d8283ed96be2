#include "tests/hardware/velodyne_encoder.h"

#include <algorithm>
#include <cmath>
#include <fstream>

namespace rgbdt {
namespace {

using Encoded = VelodyneEncoder::Model;

// Manuals' tables in the order of the lasers.
constexpr double kVlp16[] = {-15, 1, -13, 3, -11, 5, -9, 7, -7, 9, -5, 11, -3, 13, -1, 15};
constexpr double kVlp32c[] = {-25,    -1,    -1.667, -15.639, -11.31, 0,     -0.667, -8.843,
                              -7.254, 0.333, -0.333, -6.148,  -5.333, 1.333, 0.667,  -4,
                              -4.667, 1.667, 1,      -3.667,  -3.333, 3.333, 2.333,  -2.667,
                              -3,     7,     4.667,  -2.333,  -2,     15,    10.333, -1.333};
constexpr double kAside32c[] = {1.4,  -4.2, 1.4,  -1.4, 1.4,  -1.4, 4.2,  -1.4, 1.4,  -4.2, 1.4,
                                -1.4, 4.2,  -1.4, 4.2,  -1.4, 1.4,  -4.2, 1.4,  -4.2, 4.2,  -1.4,
                                1.4,  -1.4, 1.4,  -1.4, 1.4,  -4.2, 4.2,  -1.4, 1.4,  -1.4};
constexpr double kHdl32e[] = {-30.67, -9.33, -29.33, -8,    -28,    -6.67, -26.67, -5.33,
                              -25.33, -4,    -24,    -2.67, -22.67, -1.33, -21.33, 0,
                              -20,    1.33,  -18.67, 2.67,  -17.33, 4,     -16,    5.33,
                              -14.67, 6.67,  -13.33, 8,     -12,    9.33,  -10.67, 10.67};

template <typename T>
void Little(std::vector<std::uint8_t>* to, T value, int bytes) {
  for (int i = 0; i < bytes; ++i) to->push_back(static_cast<std::uint8_t>(value >> 8 * i & 255));
}

void Append(std::string* to, std::uint64_t value, int bytes, bool big = false) {
  for (int i = 0; i < bytes; ++i) {
    const int shift = 8 * (big ? bytes - 1 - i : i);
    to->push_back(static_cast<char>(value >> shift & 255));
  }
}

}  // namespace

int VelodyneEncoder::lasers() const {
  return model == Encoded::kVlp16 ? 16 : model == Encoded::kHdl64e ? 64 : 32;
}

double VelodyneEncoder::Elevation(int laser) const {
  switch (model) {
    case Encoded::kVlp16:
      return kVlp16[laser];
    case Encoded::kVlp32c:
      return kVlp32c[laser];
    case Encoded::kHdl32e:
      return kHdl32e[laser];
    case Encoded::kHdl64e:
      break;
  }
  return -laser;  // the nominal angles are the driver's own; a scene here is by laser
}

double VelodyneEncoder::LaserTime_us(int laser) const {
  const int pair = laser / 2;
  switch (model) {
    case Encoded::kVlp16:
      return 2.304 * laser;
    case Encoded::kVlp32c:
      return 2.304 * pair;
    case Encoded::kHdl32e:
      return 1.152 * laser;
    case Encoded::kHdl64e:
      break;
  }
  return 1.2 * (laser % 32);
}

double VelodyneEncoder::BlockTime_us() const {
  return model == Encoded::kVlp16    ? 2 * 55.296
         : model == Encoded::kVlp32c ? 55.296
         : model == Encoded::kHdl32e ? 46.08
                                     : 48;
}

double VelodyneEncoder::PacketDuration_us() const {
  const int blocks = 12 / ((dual ? 2 : 1) * (model == Encoded::kHdl64e ? 2 : 1));
  return blocks * BlockTime_us();
}

double VelodyneEncoder::Azimuth(int laser, int column, double block_deg) const {
  const double time = LaserTime_us(laser) + 55.296 * column;
  const double aside = model == Encoded::kVlp32c ? kAside32c[laser] : 0;
  return block_deg + block_turn / 100.0 * time / BlockTime_us() + aside;
}

std::vector<std::uint8_t> VelodyneEncoder::Packet(int number) const {
  const int halves = model == Encoded::kHdl64e ? 2 : 1;
  const int per_turn = halves * (dual ? 2 : 1);
  const double unit = model == Encoded::kVlp32c ? 0.004 : 0.002;
  std::vector<std::uint8_t> bytes;
  for (int block = 0; block < 12; ++block) {
    const int turn = number * (12 / per_turn) + block / per_turn;
    const int azimuth = (first_azimuth + turn * block_turn) % 36000;
    const bool lower = halves == 2 && block % 2 == 1;
    const bool second = dual && block / halves % 2 == 1;
    Little(&bytes, lower ? 0xddffu : 0xeeffu, 2);
    Little(&bytes, static_cast<unsigned>(azimuth), 2);
    for (int i = 0; i < 32; ++i) {
      const int laser = model == Encoded::kVlp16 ? i % 16 : i + (lower ? 32 : 0);
      const double at = Azimuth(laser, model == Encoded::kVlp16 ? i / 16 : 0, azimuth / 100.0);
      double metres = scene.distance(Elevation(laser), at);
      if (second && metres > 0) metres += 1;
      Little(&bytes, static_cast<unsigned>(std::lround(metres / unit)), 2);
      bytes.push_back(
          static_cast<std::uint8_t>(scene.reflectivity(Elevation(laser), at) + (second ? -1 : 0)));
    }
  }
  const auto stamp =
      static_cast<std::uint64_t>(std::llround(first_stamp_us + number * PacketDuration_us()));
  Little(&bytes, static_cast<std::uint32_t>(stamp % 3'600'000'000), 4);
  bytes.push_back(dual ? 0x39 : 0x37);
  bytes.push_back(model == Encoded::kVlp16    ? 0x22
                  : model == Encoded::kVlp32c ? 0x28
                  : model == Encoded::kHdl32e ? 0x21
                                              : 0x05);
  return bytes;
}

int VelodyneEncoder::PacketsPerTurn() const {
  const int halves = model == Encoded::kHdl64e ? 2 : 1;
  return 36000 / block_turn * halves * (dual ? 2 : 1) / 12;
}

double MadeUpDistance(double elevation_deg, double azimuth_deg) {
  const double azimuth = std::fmod(azimuth_deg + 720, 360);
  if (azimuth > 30 && azimuth < 40) return 0;
  return 4 + std::sin(3 * azimuth * M_PI / 180) + 0.02 * elevation_deg;
}

int MadeUpReflectivity(double elevation_deg, double azimuth_deg) {
  return 100 + static_cast<int>(50 * std::cos(azimuth_deg * M_PI / 180) + elevation_deg);
}

VelodyneEncoder MadeUpVelodyne(VelodyneEncoder::Model model) {
  VelodyneEncoder encoder;
  encoder.model = model;
  encoder.block_turn = model == Encoded::kVlp16 ? 40 : 20;
  encoder.first_azimuth = 9000;
  encoder.first_stamp_us = 3'599'900'000;
  encoder.scene = {MadeUpDistance, MadeUpReflectivity};
  return encoder;
}

void PcapWriter::Begin() {
  const std::uint64_t type = link == Link::kCooked ? 113 : link == Link::kRaw ? 101 : 1;
  bytes.clear();
  if (next_generation) {
    for (const std::uint64_t v : {0x0a0d0d0aULL, 28ULL, 0x1a2b3c4dULL}) Append(&bytes, v, 4);
    Append(&bytes, 1, 4);
    Append(&bytes, ~0ULL, 8);
    Append(&bytes, 28, 4);
    for (const std::uint64_t v : {1ULL, 20ULL}) Append(&bytes, v, 4);
    Append(&bytes, type, 4);
    Append(&bytes, 65535, 4);
    Append(&bytes, 20, 4);
    return;
  }
  Append(&bytes, 0xa1b2c3d4, 4);
  Append(&bytes, 2, 2);
  Append(&bytes, 4, 2);
  Append(&bytes, 0, 8);
  Append(&bytes, 65535, 4);
  Append(&bytes, type, 4);
}

void PcapWriter::Add(std::int64_t utime, const std::vector<std::uint8_t>& payload,
                     std::size_t captured) {
  std::string frame;
  if (link == Link::kEthernet) frame = std::string(12, '\1') + std::string("\x08\x00", 2);
  if (link == Link::kVlan) {
    frame = std::string(12, '\1') + std::string("\x81\x00\x00\x07\x08\x00", 6);
  }
  if (link == Link::kCooked) frame = std::string(14, '\0') + std::string("\x08\x00", 2);
  frame += std::string("\x45\x00", 2);
  Append(&frame, 28 + payload.size(), 2, true);
  frame += std::string("\x00\x00\x00\x00\xff\x11\x00\x00", 8);
  frame.append(from.begin(), from.end());
  frame += std::string("\xff\xff\xff\xff", 4);
  Append(&frame, 2368, 2, true);
  Append(&frame, static_cast<std::uint64_t>(port), 2, true);
  Append(&frame, 8 + payload.size(), 2, true);
  Append(&frame, 0, 2, true);
  frame.append(payload.begin(), payload.end());
  const std::size_t kept = std::min(captured, frame.size());
  const auto time = static_cast<std::uint64_t>(utime);
  if (next_generation) {
    const std::size_t padded = (kept + 3) / 4 * 4;
    Append(&bytes, 6, 4);
    Append(&bytes, 32 + padded, 4);
    Append(&bytes, 0, 4);
    Append(&bytes, time >> 32, 4);
    Append(&bytes, time & 0xffffffff, 4);
    Append(&bytes, kept, 4);
    Append(&bytes, frame.size(), 4);
    bytes += frame.substr(0, kept) + std::string(padded - kept, '\0');
    Append(&bytes, 32 + padded, 4);
    return;
  }
  Append(&bytes, time / 1'000'000, 4);
  Append(&bytes, time % 1'000'000, 4);
  Append(&bytes, kept, 4);
  Append(&bytes, frame.size(), 4);
  bytes += frame.substr(0, kept);
}

void PcapWriter::Save(const std::string& path) const {
  std::ofstream(path, std::ios::binary) << bytes;
}

}  // namespace rgbdt
