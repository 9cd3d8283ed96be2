#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace rgbdt {

/// How a camera is found, set and triggered (rgbdt-camera).
struct CameraDevice {
  enum class Trigger {
    kFree = 0,      ///< as fast as its features say
    kSoftware = 1,  ///< one image a capture command
    kHardware = 2,  ///< by a signal on its line 1
  };
  enum class Wire {
    kRaw = 0,  ///< Bayer or Mono as the sensor gives it
    kJpeg = 1,
    kPng = 2,
  };
  std::string serial, address, id;  ///< one of them; address: IP of a GigE Vision camera
  std::vector<std::pair<std::string, std::string>> features;  ///< GenICam name, value; in order
  Trigger trigger = Trigger::kFree;
  std::optional<Wire> wire;  ///< absent: by where the bus goes (WireOf)
  int packet_bytes = 0;      ///< GigE Vision stream packets; 0: the largest that arrives
};

/// A Hokuyo scanner with SCIP 2.0 over TCP.
struct HokuyoDevice {
  std::string address;
  int port = 10940;
};

/// A Velodyne LIDAR over UDP, or a recording of its packets.
struct VelodyneDevice {
  enum class Model { kVlp16 = 1, kVlp32c = 2, kHdl32e = 3, kHdl64e = 4 };
  Model model = Model::kVlp16;
  int port = 2368;
  std::string pcap;  ///< a file instead of the network; empty: none
};

/// An Ouster, Hesai, Livox or RoboSense over UDP, or a recording of its packets.
struct PacketLidarDevice {
  enum class Make { kOuster, kHesai, kLivox, kRobosense };
  Make make = Make::kOuster;
  /// A file: an Ouster's JSON, a Hesai's angles (CSV); a Livox: none; a RoboSense: its angles
  /// (CSV), or none, as its packets tell them, too.
  std::string metadata;
  int port = 0;
  std::string pcap;  ///< a file instead of the network; empty: none
};

/// The name of its maker: "Ouster".
inline const char* MakerOf(PacketLidarDevice::Make make) {
  const char* const names[] = {"Ouster", "Hesai", "Livox", "RoboSense"};
  return names[static_cast<int>(make)];
}
/// The port that such a LIDAR sends to unless it is told otherwise.
inline int DefaultPort(PacketLidarDevice::Make make) {
  const int ports[] = {7502, 2368, 56301, 6699};
  return ports[static_cast<int>(make)];
}

/// A folder of PCD files, one a sweep, in the order of their names.
struct PcdFolderDevice {
  std::string folder;
  double period_s = 1;  ///< between two sweeps where the files bring no times
};

/// A Dynamixel servo with Protocol 2.0 on a serial port, which turns a scanner.
struct DynamixelDevice {
  std::string port;  ///< "/dev/ttyUSB0"
  int baud = 57600;
  int id = 1;
  double from_rad = 0, to_rad = 0;  ///< a sweep's two ends
  double speed_rad_s = 0;           ///< of a sweep, above 0
};

}  // namespace rgbdt
