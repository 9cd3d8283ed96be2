#include "services/packets/recording.h"

#include <algorithm>
#include <optional>

#include "calib/files/atomic_file.h"
#include "calib/files/points/cloud_files.h"
#include "calib/model/errors.h"
#include "calib/model/text.h"
#include "services/drivers/packets/packet_sweeps.h"
#include "services/drivers/pcap/pcap_reader.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;

// Every datagram until the end, or until it is cut off: then why.
std::string ForEach(const fs::path& path,
                    const std::function<void(const PcapReader::Datagram&)>& take) {
  PcapReader reader(path.string());
  while (true) {
    std::optional<PcapReader::Datagram> datagram;
    try {
      datagram = reader.Next();
    } catch (const InputError& error) {
      return error.what();
    }
    if (!datagram) return "";
    take(*datagram);
  }
}

// Which LIDAR sent these packets; of several, which sent most.
class Finder {
  static constexpr std::size_t kMostSenders = 65'536;  // looked at

 public:
  explicit Finder(const RecordingOptions& options) : wanted_(options.port) {
    if (options.metadata.empty()) return;
    known_ = PacketsByMetadata(ReadWholeFile(options.metadata), options.metadata.string());
  }

  void Look(const PcapReader::Datagram& datagram) {
    const Sender sender{datagram.port, datagram.from};
    if (all_.size() >= kMostSenders && all_.count(sender) == 0) return;
    ++all_[sender];
    if (datagram.cut || (wanted_ != 0 && datagram.port != wanted_)) return;
    if (known_) {
      if (known_->IsOurs(datagram.payload)) ++ours_[sender];
      return;
    }
    std::unique_ptr<PacketSweeps>& seen = seen_[sender];
    if (!seen) seen = PacketsByThemselves(datagram.payload);
    if (seen && seen->IsOurs(datagram.payload)) ++ours_[sender];
  }

  // Throws InputError where there is none.
  std::unique_ptr<PacketSweeps> Found(const fs::path& path, Sender* sender) {
    const auto most =
        std::max_element(ours_.begin(), ours_.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    if (most == ours_.end()) {
      std::string ports;
      constexpr std::size_t kMost = 8;
      std::map<int, std::int64_t> by_port;
      for (const auto& [other, count] : all_) by_port[other.port] += count;
      for (const auto& [other, count] : by_port) {
        if (ports.size() > 16 * kMost) break;
        ports += Format(" %d (%lld)", other, static_cast<long long>(count));
      }
      throw InputError(path.string() + ": has no packets of " +
                       (known_ ? "the " + known_->name() + " of --metadata" : kSelfTellingLidars) +
                       (wanted_ == 0 ? "" : " to UDP port " + std::to_string(wanted_)) +
                       (ports.empty() ? "; no UDP at all" : "; UDP ports (datagrams):" + ports));
    }
    *sender = most->first;
    return known_ ? std::move(known_) : std::move(seen_.at(most->first));
  }
  const std::map<Sender, std::int64_t>& all() const { return all_; }

 private:
  int wanted_;
  std::unique_ptr<PacketSweeps> known_;  // by what the user says
  std::map<Sender, std::unique_ptr<PacketSweeps>> seen_;
  std::map<Sender, std::int64_t> ours_, all_;
};

void RequireEmpty(const fs::path& dir) {
  std::error_code error;
  if (!fs::exists(dir, error)) return;
  if (!fs::is_directory(dir, error) || !fs::is_empty(dir, error) || error) {
    throw InputError(dir.string() + ": is there and not empty; expected a new folder");
  }
}

}  // namespace

Recording ReadRecording(const fs::path& path, const RecordingOptions& options,
                        const std::function<void(const Cloud&)>& take) {
  Finder finder(options);
  ForEach(path, [&](const PcapReader::Datagram& datagram) { finder.Look(datagram); });
  Recording recording;
  const std::unique_ptr<PacketSweeps> sweeps = finder.Found(path, &recording.sender);
  recording.others = finder.all();
  recording.others.erase(recording.sender);
  recording.others.erase({sweeps->information_port(), recording.sender.from});
  const auto give = [&](const Cloud& sweep) {
    if (recording.sweeps++ == 0) recording.first = sweep.sweep_utime;
    recording.last = sweep.sweep_utime;
    take(sweep);
  };
  recording.cut_off = ForEach(path, [&](const PcapReader::Datagram& datagram) {
    const bool to_its_ports =
        datagram.port == recording.sender.port ||
        (sweeps->information_port() != 0 && datagram.port == sweeps->information_port());
    const bool is_its = to_its_ports && datagram.from == recording.sender.from;
    if (!is_its || !sweeps->IsOurs(datagram.payload)) return;
    ++recording.packets;
    std::vector<Cloud> done;
    try {
      if (datagram.cut) throw InputError("a packet was recorded cut short");
      done = sweeps->Add(datagram.payload, datagram.utime);
    } catch (const InputError& error) {
      ++recording.bad;
      recording.last_problem = error.what();
    }
    for (const Cloud& sweep : done) give(sweep);
  });
  if (const auto sweep = sweeps->Finish()) give(*sweep);
  recording.sensor = sweeps->name();
  recording.lost = sweeps->Lost();
  return recording;
}

std::string PcdName(Utime utime) {
  return Format("%lld.%06lld.pcd", static_cast<long long>(utime / kMicrosecondsPerSecond),
                static_cast<long long>(utime % kMicrosecondsPerSecond));
}

Recording WriteRecordingAsPcds(const fs::path& path, const RecordingOptions& options,
                               const fs::path& dir) {
  RequireEmpty(dir);
  return ReadRecording(path, options, [&](const Cloud& sweep) {
    WritePcd(dir / PcdName(sweep.sweep_utime), sweep);
  });
}

}  // namespace rgbdt
