#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/cloud.h"
#include "calib/model/devices.h"
#include "services/drivers/hesai/hesai_packets.h"
#include "services/drivers/ouster/ouster_metadata.h"

namespace rgbdt {

/// A LIDAR's packets -> sweeps, whatever the LIDAR. Each point of a sweep has its range (its
/// distance from the line's origin), direction, ring, time and reflectivity (0 to 1).
class PacketSweeps {
 public:
  using Payload = std::vector<std::uint8_t>;
  virtual ~PacketSweeps() = default;

  virtual std::string name() const = 0;  ///< "OS-1-64"
  /// Of a Velodyne none.
  virtual std::optional<PacketLidarDevice::Make> make() const { return std::nullopt; }
  /// Whether a datagram is of this kind, by its size and what it begins with.
  virtual bool IsOurs(const Payload& payload) const = 0;
  /// The sweeps that it ended; it arrived at `arrival` [us, UTC]. Throws InputError for a packet
  /// that cannot be decoded; the next one may come.
  virtual std::vector<Cloud> Add(const Payload& payload, Utime arrival) = 0;
  /// The one under way at the end, where all of it came.
  virtual std::optional<Cloud> Finish() = 0;
  /// Name (sweep_utime) of the sweep that has begun; 0: none.
  virtual Utime begun() const = 0;

  struct Loss {
    const char* counter;  ///< "lost columns"
    const char* words;    ///< after the number: "columns never came"
    std::int64_t count;
  };
  /// What never came.
  virtual std::vector<Loss> Losses() const = 0;
  /// The same in words; empty: all came.
  std::string Lost() const;
  /// Another port to which the LIDAR sends what tells how to decode; 0: none.
  virtual int information_port() const { return 0; }
  /// How often somebody set the sensor's clock or the host's, where that is known.
  virtual std::int64_t clock_steps() const { return 0; }
};

std::unique_ptr<PacketSweeps> VelodynePackets(VelodyneDevice::Model model);

std::unique_ptr<PacketSweeps> OusterPackets(ouster::Metadata metadata);
/// Of the model that has so many channels. Throws InputError where none has.
std::unique_ptr<PacketSweeps> HesaiPackets(hesai::Angles angles);

/// What a file says of a sensor: an Ouster's metadata (JSON), a Hesai's angles (CSV of three
/// columns) or a RoboSense's (of two). Throws InputError, which begins with `where`, for none of
/// them.
std::unique_ptr<PacketSweeps> PacketsByMetadata(const std::string& text, const std::string& where);

/// Of the Livox (Mid-360, Avia) that a packet tells of by itself; none: it is no such packet.
std::unique_ptr<PacketSweeps> LivoxPackets(const PacketSweeps::Payload& payload);
/// A RoboSense by its own packets. Those of before one that tells the angles are passed over.
std::unique_ptr<PacketSweeps> RobosensePackets();
/// Of a Livox, a Velodyne (VLP-16, VLP-32C, HDL-32E) or a RoboSense.
std::unique_ptr<PacketSweeps> PacketsByThemselves(const PacketSweeps::Payload& payload);

/// Those of PacketsByThemselves, and what to do about others, for a message.
inline constexpr const char* kSelfTellingLidars =
    "a VLP-16, VLP-32C, HDL-32E, Livox Mid-360 or Avia, or a RoboSense; of an Ouster or a Hesai, "
    "give --metadata";

}  // namespace rgbdt
