#pragma once

#include <map>
#include <string>

namespace rgbdt::fuzz {

/// By target and name.
using Seeds = std::map<std::string, std::map<std::string, std::string>>;

void AddBusSeeds(Seeds* seeds);       ///< message, datagrams, log, keys and signatures
void AddNodeSeeds(Seeds* seeds);      ///< nodes, viewer_node, sweep_collector
void AddFileSeeds(Seeds* seeds);      ///< text files, lenses, clouds, images
void AddBagSeeds(Seeds* seeds);       ///< bag, bag_sqlite, ros_message, bag_import
void AddFoxgloveSeeds(Seeds* seeds);  ///< more of bag and ros_message
void AddDeviceSeeds(Seeds* seeds);    ///< scip, velodyne, livox, pcap_file, dynamixel, camera
void AddPacketSeeds(Seeds* seeds);    ///< ouster, hesai, robosense, recording, bag_packets
void AddViewerSeeds(Seeds* seeds);    ///< viewer_message, viewer_http, viewer_socket

/// The length as a big-endian word, and the bytes: Input::Piece.
std::string Piece(const std::string& bytes);

/// The bytes that `write` puts into the file whose path it gets.
template <typename Write>
std::string Written(Write write);

}  // namespace rgbdt::fuzz

#include "calib/files/atomic_file.h"
#include "tests/unit/files/test_data.h"

template <typename Write>
std::string rgbdt::fuzz::Written(Write write) {
  const test::TempDir dir;
  write(dir / "seed");
  return ReadWholeFile(dir / "seed");
}
