#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "services/bags/bag_reader.h"
#include "services/drivers/packets/packet_sweeps.h"
#include "services/import/survey.h"

namespace rgbdt {

struct BagPacketsOptions {
  std::string topic;  ///< of the packets
  std::string
      metadata;  ///< an Ouster's JSON, a Hesai's or RoboSense's CSV, its text; empty: none needed
  std::string metadata_name;  ///< file or topic, for messages
};

/// A LIDAR's packets in a bag -> the sweeps that a recording of the same packets (pcap) gives, bit
/// for bit. What a decoder makes of a packet depends on those before it, so the bag is read from
/// its begin: once for the sweeps' times, once more for those that are wanted. Holds one sweep.
class BagPackets {
 public:
  /// Throws InputError: no bag, no such topic, metadata that cannot be read.
  BagPackets(std::filesystem::path bag, BagPacketsOptions options);

  /// Of each sweep when it begins, and its place: its number. `progress` gets 0 to 1. Throws
  /// InputError where the topic has no whole sweep, with why.
  std::vector<Stamped> Find(const std::function<void(double)>& progress);
  /// One that Find gave. In order of their places the bag is read once.
  Cloud Read(const Stamped& stamped);

  /// What there is to say of it, a line each: the LIDAR, what was lost or could not be read. Once
  /// Find has been called.
  const std::vector<std::string>& lines() const { return lines_; }

 private:
  void Rewind();
  bool Next(Cloud* sweep);
  void Take(const BagMessage& message);
  void Decode(const PacketSweeps::Payload& payload, Utime arrival);

  std::filesystem::path path_;
  BagPacketsOptions options_;
  std::unique_ptr<BagReader> bag_;
  std::unique_ptr<PacketSweeps> sweeps_;  // none yet: no packet told which LIDAR
  std::vector<Cloud> ready_;              // completed and not yet given, the last one first
  std::int64_t given_ = 0, packets_ = 0, bad_ = 0, others_ = 0;
  std::string last_problem_;
  bool ended_ = false;
  std::vector<std::string> lines_;
};

}  // namespace rgbdt
