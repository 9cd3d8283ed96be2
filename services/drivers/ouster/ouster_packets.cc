#include "services/drivers/ouster/ouster_packets.h"

#include <cmath>

#include "calib/model/errors.h"

namespace rgbdt::ouster {
namespace {

constexpr std::size_t kPacketHead = 32;  // not of legacy packets
constexpr std::size_t kLegacyColumnHead = 16, kColumnHead = 12;
constexpr std::uint32_t kRangeMask = 0x7ffff;        // 19 bits
constexpr std::uint32_t kLegacyRangeMask = 0xfffff;  // 20
constexpr std::uint32_t kLowBandwidthMask = 0x7fff;  // 15, of 8 mm each
constexpr std::uint32_t kLowBandwidthUnit_mm = 8;

std::uint64_t Number(const std::uint8_t* bytes, std::size_t count) {
  std::uint64_t number = 0;
  for (std::size_t i = count; i-- > 0;) number = number << 8 | bytes[i];
  return number;
}

Return Wide(const std::uint8_t* bytes, std::uint32_t mask, std::size_t reflectivity_at) {
  return {static_cast<std::uint32_t>(Number(bytes, 4)) & mask, bytes[reflectivity_at]};
}

Return ReturnOf(Profile profile, const std::uint8_t* beam) {
  switch (profile) {
    case Profile::kLegacy:
      return Wide(beam, kLegacyRangeMask, 4);
    case Profile::kSingle:
      return Wide(beam, kRangeMask, 4);
    case Profile::kDual:
      return Wide(beam, kRangeMask, 3);
    case Profile::kLowBandwidth:
      return {
          (static_cast<std::uint32_t>(Number(beam, 2)) & kLowBandwidthMask) * kLowBandwidthUnit_mm,
          beam[2]};
  }
  return {};
}

}  // namespace

Packet Decode(const Metadata& metadata, const std::uint8_t* data, std::size_t size) {
  if (size != metadata.PacketBytes()) {
    throw InputError(metadata.model + " packet: has " + std::to_string(size) +
                     " bytes; by the metadata it has " + std::to_string(metadata.PacketBytes()));
  }
  const bool legacy = metadata.profile == Profile::kLegacy;
  const std::uint8_t* column_at = data + (legacy ? 0 : kPacketHead);
  Packet packet;
  packet.frame = static_cast<int>(Number(legacy ? data + 10 : data + 2, 2));
  packet.columns.resize(static_cast<std::size_t>(metadata.columns_per_packet));
  for (Column& column : packet.columns) {
    const std::uint8_t* end = column_at + metadata.ColumnBytes();
    column.time_ns = static_cast<std::int64_t>(Number(column_at, 8) & INT64_MAX);
    column.measurement = static_cast<int>(Number(column_at + 8, 2));
    column.valid = ((legacy ? Number(end - 4, 4) : Number(column_at + 10, 2)) & 1) != 0;
    if (column.measurement >= metadata.columns_per_frame) {
      throw InputError(metadata.model + " packet: is of column " +
                       std::to_string(column.measurement) + "; by the metadata a turn has " +
                       std::to_string(metadata.columns_per_frame));
    }
    const std::uint8_t* beam = column_at + (legacy ? kLegacyColumnHead : kColumnHead);
    for (int row = 0; row < metadata.rows; ++row, beam += metadata.BeamBytes()) {
      column.returns.push_back(ReturnOf(metadata.profile, beam));
      if (metadata.profile == Profile::kDual) {
        column.second_returns.push_back(Wide(beam + 4, kRangeMask, 3));
      }
    }
    column_at = end;
  }
  return packet;
}

Beam BeamOf(const Metadata& metadata, int row, int measurement) {
  const auto r = static_cast<std::size_t>(row);
  const double encoder =
      2 * M_PI *
      (1 - static_cast<double>(measurement) / static_cast<double>(metadata.columns_per_frame));
  const double azimuth = encoder - metadata.azimuth_rad[r];
  const double altitude = metadata.altitude_rad[r];
  const Eigen::Vector3d direction(std::cos(azimuth) * std::cos(altitude),
                                  std::sin(azimuth) * std::cos(altitude), std::sin(altitude));
  const Eigen::Vector3d beam_origin(metadata.beam_origin_m.x() * std::cos(encoder),
                                    metadata.beam_origin_m.x() * std::sin(encoder),
                                    metadata.beam_origin_m.y());
  // The range counts from the axis, by way of the beam's origin.
  const Eigen::Vector3d zero = beam_origin - metadata.beam_origin_m.norm() * direction;
  return {metadata.sensor_from_lidar * zero, metadata.sensor_from_lidar.rotation * direction};
}

}  // namespace rgbdt::ouster
