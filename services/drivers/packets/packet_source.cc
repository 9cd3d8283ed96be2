#include "services/drivers/packets/packet_source.h"

#include <chrono>
#include <cstdlib>
#include <map>
#include <optional>
#include <utility>

#include "calib/files/atomic_file.h"
#include "calib/model/errors.h"
#include "calib/model/text.h"
#include "calib/scan_assembly/sweep_chunks.h"
#include "services/drivers/packets/udp_port.h"
#include "services/drivers/pcap/pcap_reader.h"
#include "services/drivers/velodyne/velodyne_packets.h"
#include "services/posix/clock.h"
#include "services/runtime/pacer.h"

namespace rgbdt {
namespace {

using Clock = std::chrono::steady_clock;
using Make = PacketLidarDevice::Make;

constexpr int kSliceMs = 50;                     // how soon a stop is seen
constexpr std::chrono::seconds kMostSilence{2};  // without packets
constexpr char kNominal[] =
    "HDL-64E: its lasers' angles are nominal, up to several degrees off; its calibration file is "
    "not read, so look at its clouds, but do not calibrate with them";

std::unique_ptr<PacketSweeps> SweepsOf(const PacketLidarDevice& device) {
  if (device.make == Make::kLivox) return nullptr;
  if (device.make == Make::kRobosense && device.metadata.empty()) return RobosensePackets();
  const bool is_ouster = device.make == Make::kOuster;
  const std::string file =
      is_ouster ? "the sensor's metadata (JSON; http://SENSOR/api/v1/sensor/metadata has it)"
      : device.make == Make::kHesai
          ? "the angle correction file that came with it (CSV)"
          : "its angles (CSV: elevation, azimuth [degrees], a line a channel)";
  if (device.metadata.empty()) {
    throw InputError(std::string("the rig's lidar: ") + (is_ouster ? "ouster" : "hesai") +
                     " needs metadata: \"FILE\", " + file);
  }
  auto sweeps = PacketsByMetadata(ReadWholeFile(device.metadata), device.metadata);
  if (sweeps->make() != device.make) {
    throw InputError(device.metadata + ": describes no " + MakerOf(device.make) + " but a " +
                     sweeps->name() + "; expected " + file);
  }
  return sweeps;
}

// Counters of the report.
constexpr const char* kPackets = "packets";
constexpr const char* kInformation = "information packets";

}  // namespace

PacketSource::PacketSource(const VelodyneDevice& device)
    : PacketSource({device.port, device.pcap, ""}, VelodynePackets(device.model),
                   velodyne::SensorOf(device.model).name) {}

PacketSource::PacketSource(const PacketLidarDevice& device)
    : PacketSource({device.port, device.pcap, device.metadata}, SweepsOf(device),
                   MakerOf(device.make)) {}

PacketSource::PacketSource(Link link, std::unique_ptr<PacketSweeps> sweeps, std::string name)
    : link_(std::move(link)), sweeps_(std::move(sweeps)), name_(std::move(name)) {
  if (sweeps_) name_ = sweeps_->name();
  if (!link_.pcap.empty()) const PcapReader opens(link_.pcap);
}

void PacketSource::Serve(DeviceThread& thread) {
  if (name_ == velodyne::SensorOf(VelodyneDevice::Model::kHdl64e).name) thread.Warn(kNominal);
  try {
    link_.pcap.empty() ? Listen(thread) : Play(thread);
  } catch (const std::exception& e) {
    report_.Set(std::string("tries again: ") + e.what(), false);
    throw;
  }
}

int PacketSource::InformationPort() const { return sweeps_ ? sweeps_->information_port() : 0; }

std::string PacketSource::OthersText() const {
  return Format("packets come, the last one of %zu bytes, but none with sweeps of a %s; ",
                other_bytes_, name_.c_str()) +
         (link_.metadata.empty()
              ? "is it another LIDAR, or its port for other data?"
              : "is " + link_.metadata + " of this very LIDAR, as it is set up now?");
}

void PacketSource::Listen(DeviceThread& thread) {
  UdpPort udp(link_.port);
  std::optional<UdpPort> information;
  if (InformationPort() != 0) information.emplace(InformationPort());
  port_ = udp.port();
  const std::string where = "UDP port " + std::to_string(udp.port());
  report_.Set("waits for packets at " + where, false);
  auto last = Clock::now();
  // What LIDARs tell of themselves, by sender: of others on this network, too.
  constexpr std::size_t kMostTold = 16;
  std::map<std::uint32_t, UdpPort::Datagram> told;
  std::int64_t packets = report_.count("packets"), bad = report_.count("bad packets"),
               others = report_.count("other packets");
  while (!thread.Stopping()) {
    const auto datagram = udp.Receive(kSliceMs);
    if (information) {
      auto tells = information->Receive(0);
      if (tells && (told.size() < kMostTold || told.count(tells->sender) != 0)) {
        told[tells->sender] = std::move(*tells);
      }
    }
    if (datagram) {
      const auto own = told.find(datagram->sender);
      if (own != told.end()) {
        Take(thread, own->second.payload, own->second.utime, kInformation);
        told.erase(own);
      }
      Take(thread, datagram->payload, datagram->utime, kPackets);
    }
    if (report_.count("packets") != packets) {
      packets = report_.count("packets");
      last = Clock::now();
    }
    if (Clock::now() - last <= kMostSilence) continue;
    last = Clock::now();
    if (report_.count("bad packets") != bad) {  // each of them was named
      bad = report_.count("bad packets");
      report_.Set("hears only bad packets at " + where, false);
    } else if (report_.count("other packets") != others) {
      others = report_.count("other packets");
      report_.Set("hears nothing that it knows at " + where, false);
      thread.Warn(where + ": " + OthersText());
    } else {
      report_.Set("hears nothing at " + where, false);
      thread.Warn(where +
                  ": no packets for 2 s; is the LIDAR on, does it send to this "
                  "machine's address and this port, and does a firewall let it in?");
    }
  }
}

// Damage in a recording ends it: trying again would not mend it.
void PacketSource::Play(DeviceThread& thread) {
  PcapReader recording(link_.pcap);
  report_.Set("plays " + link_.pcap, false);
  Pacer pacer;
  std::int64_t to_port = 0, to_others = 0;
  try {
    while (const auto datagram = recording.Next()) {
      const bool tells = InformationPort() != 0 && datagram->port == InformationPort();
      if (datagram->port != link_.port && !tells) {
        ++to_others;
        continue;
      }
      if (datagram->port == link_.port) ++to_port;
      if (!thread.Sleep(pacer.WaitFor(datagram->utime, SteadyUtime()))) return;
      if (datagram->cut) {
        report_.Count("bad packets");
        thread.Warn(link_.pcap + ": was recorded with packets cut short; record them whole");
        continue;
      }
      Take(thread, datagram->payload, datagram->utime,
           datagram->port == link_.port ? kPackets : kInformation);
    }
  } catch (const InputError& e) {
    thread.Warn(e.what());
  }
  if (to_port == 0) {
    thread.Warn(link_.pcap + ": has no packets to UDP port " + std::to_string(link_.port) +
                ", but " + std::to_string(to_others) +
                " to others; correct the port in the rig file");
  } else if (report_.count("packets") + report_.count("bad packets") == 0) {
    thread.Warn(link_.pcap + ": " + OthersText());
  }
  if (sweeps_) {
    if (const auto sweep = sweeps_->Finish()) Publish(thread, *sweep);
  }
  report_.Set(link_.pcap + " has ended", true);
}

void PacketSource::Take(DeviceThread& thread, const std::vector<std::uint8_t>& payload, Utime utime,
                        const char* counter) {
  if (!sweeps_) {
    sweeps_ = LivoxPackets(payload);
  }
  if (!sweeps_ || !sweeps_->IsOurs(payload)) {
    other_bytes_ = payload.size();
    report_.Count("other packets");
    return;
  }
  std::vector<Cloud> done;
  try {
    done = sweeps_->Add(payload, utime);
  } catch (const InputError& e) {
    report_.Count("bad packets");
    thread.Warn(e.what());
    return;
  }
  report_.SetSweepBegun(sweeps_->begun());
  report_.Count(counter);
  const std::int64_t lost = ReportLosses(thread);
  name_ = sweeps_->name();
  if (!done.empty()) LookAt(thread, done.back(), lost, utime);
  for (const Cloud& sweep : done) Publish(thread, sweep);
}

// What makes a whole sweep useless, and is no error of a packet.
void PacketSource::LookAt(DeviceThread& thread, const Cloud& sweep, std::int64_t lost,
                          Utime arrival) const {
  constexpr Utime kMostApart = 2 * kMicrosecondsPerSecond;  // a Livox's sweep lasts a second
  if (!link_.metadata.empty() && 2 * lost >= sweep.beams) {
    thread.Warn(name_ + ": half of its columns or more never came; is " + link_.metadata +
                " of this very LIDAR, as it is set up now (columns, azimuth window)?");
  }
  const Utime behind = arrival - sweep.sweep_utime;
  if (link_.pcap.empty() && std::abs(behind) > kMostApart) {
    thread.Warn(
        Format("%s: its clock is %.1f s %s this machine's, so its sweeps answer no command "
               "and belong to no image; let both follow one clock (PTP, NTP, GPS)",
               name_.c_str(), std::abs(ToSeconds(behind)), behind > 0 ? "behind" : "ahead of"));
  }
}

// How much since the last packet.
std::int64_t PacketSource::ReportLosses(DeviceThread& thread) {
  const auto losses = sweeps_->Losses();
  lost_reported_.resize(losses.size());
  std::int64_t lost = 0;
  for (std::size_t i = 0; i < losses.size(); ++i) {
    lost += losses[i].count - lost_reported_[i];
    report_.Count(losses[i].counter, losses[i].count - lost_reported_[i]);
    lost_reported_[i] = losses[i].count;
  }
  if (sweeps_->clock_steps() != steps_reported_) {
    steps_reported_ = sweeps_->clock_steps();
    thread.Warn("the LIDAR's clock or this machine's was set; the points' times begin anew");
  }
  return lost;
}

void PacketSource::Publish(DeviceThread& thread, const Cloud& sweep) {
  report_.Count("sweeps");
  for (CloudChunk& chunk : SplitSweep(sweep)) thread.Publish(std::move(chunk));
  report_.Set(name_ + (link_.pcap.empty() ? "" : " from " + link_.pcap), true);
}

}  // namespace rgbdt
