#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/model/time.h"

struct pcap;

namespace rgbdt {

/// A recording of network packets (pcap or pcapng, over Ethernet with or without VLAN tags, Linux
/// "any" captures or raw IP), as the IPv4 UDP payloads in it. Those that were sent in fragments are
/// put together: a LIDAR's packet may be several times what a network carries at once.
class PcapReader {
 public:
  /// Throws InputError naming the file where it is missing, no regular file or no recording.
  explicit PcapReader(const std::string& path);
  ~PcapReader();
  PcapReader(const PcapReader&) = delete;
  PcapReader& operator=(const PcapReader&) = delete;

  struct Datagram {
    Utime utime = 0;   ///< when it was recorded; of fragments, the last to come
    int port = 0;      ///< that it was sent to
    std::string from;  ///< address that it was sent from: "192.168.1.201"
    bool cut = false;  ///< the recording has not all of it
    std::vector<std::uint8_t> payload;
  };
  /// The next one; nothing at the end. Throws InputError where the file is damaged or cut short.
  std::optional<Datagram> Next();

 private:
  // IP packets whose fragments have come in part: few, and 64 KiB each.
  struct Fragments {
    std::vector<std::uint8_t> key;  // addresses, protocol, number
    std::vector<std::uint8_t> bytes;
    std::vector<std::pair<std::size_t, std::size_t>> have;  // begin, end
    std::size_t size = 0;                                   // of the whole; 0: not known
    Utime utime = 0;                                        // of the first to come
  };
  std::optional<std::vector<std::uint8_t>> Join(Utime utime, const std::uint8_t* header,
                                                const std::uint8_t* data, std::size_t size);

  std::string path_;
  pcap* pcap_ = nullptr;
  std::deque<Fragments> fragments_;
};

}  // namespace rgbdt
