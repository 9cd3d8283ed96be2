#include "services/drivers/velodyne/velodyne_source.h"

#include <chrono>

#include "calib/model/errors.h"
#include "calib/scan_assembly/sweep_chunks.h"
#include "services/posix/clock.h"
#include "services/runtime/pacer.h"

namespace rgbdt {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kSliceMs = 50;      // how soon a stop is seen
constexpr int kSilenceMs = 2000;  // without packets
constexpr char kNominal[] =
    "HDL-64E: its lasers' angles are nominal, up to several degrees off; its calibration file is "
    "not read, so look at its clouds, but do not calibrate with them";

}  // namespace

VelodyneSource::VelodyneSource(const VelodyneDevice& device)
    : device_(device), sweeps_(device.model) {
  if (!live()) const PcapReader opens(device_.pcap);
}

void VelodyneSource::Serve(DeviceThread& thread) {
  if (device_.model == VelodyneDevice::Model::kHdl64e) thread.Warn(kNominal);
  try {
    live() ? Listen(thread) : Play(thread);
  } catch (const std::exception& e) {
    report_.Set(std::string("tries again: ") + e.what(), false);
    throw;
  }
}

void VelodyneSource::Listen(DeviceThread& thread) {
  UdpPort udp(device_.port);
  port_ = udp.port();
  const std::string where = "UDP port " + std::to_string(udp.port());
  report_.Set("waits for packets at " + where, false);
  auto last = Clock::now();
  while (!thread.Stopping()) {
    if (const auto datagram = udp.Receive(kSliceMs)) {
      Take(thread, datagram->payload, datagram->utime);
      last = Clock::now();
    } else if (Clock::now() - last > std::chrono::milliseconds(kSilenceMs)) {
      report_.Set("hears nothing at " + where, false);
      thread.Warn(where +
                  ": no packets for 2 s; is the LIDAR on, does it send to this "
                  "machine's address and this port, and does a firewall let it in?");
      last = Clock::now();
    }
  }
}

// Damage in a recording ends it: trying again would not mend it.
void VelodyneSource::Play(DeviceThread& thread) {
  PcapReader recording(device_.pcap);
  report_.Set("plays " + device_.pcap, false);
  Pacer pacer;
  std::int64_t ours = 0, others = 0;
  try {
    while (const auto datagram = recording.Next()) {
      if (datagram->port != device_.port) {
        ++others;
        continue;
      }
      ++ours;
      if (!thread.Sleep(pacer.WaitFor(datagram->utime, SteadyUtime()))) return;
      if (datagram->cut) {
        report_.Count("bad packets");
        thread.Warn(device_.pcap + ": was recorded with packets cut short; record them whole");
        continue;
      }
      Take(thread, datagram->payload, datagram->utime);
    }
  } catch (const InputError& e) {
    thread.Warn(e.what());
  }
  if (ours == 0) {
    thread.Warn(device_.pcap + ": has no packets to UDP port " + std::to_string(device_.port) +
                ", but " + std::to_string(others) + " to others; correct the port in the rig file");
  }
  report_.Set(device_.pcap + " has ended", true);
}

void VelodyneSource::Take(DeviceThread& thread, const std::vector<std::uint8_t>& payload,
                          Utime utime) {
  if (payload.size() == velodyne::kPositionBytes) return;
  std::vector<Cloud> sweeps;
  try {
    const velodyne::Packet packet =
        velodyne::Decode(velodyne::SensorOf(device_.model), payload.data(), payload.size());
    sweeps = sweeps_.Add(packet, utime);
  } catch (const InputError& e) {
    report_.Count("bad packets");
    thread.Warn(e.what());
    return;
  }
  report_.SetSweepBegun(sweeps_.begun());
  report_.Count("packets");
  report_.Count("lost packets", sweeps_.lost_packets() - lost_reported_);
  lost_reported_ = sweeps_.lost_packets();
  if (sweeps_.clock_steps() != steps_reported_) {
    steps_reported_ = sweeps_.clock_steps();
    thread.Warn("the LIDAR's clock or this machine's was set; the points' times begin anew");
  }
  for (const Cloud& sweep : sweeps) {
    report_.Count("sweeps");
    for (CloudChunk& chunk : SplitSweep(sweep)) thread.Publish(std::move(chunk));
    report_.Set(velodyne::SensorOf(device_.model).name + (live() ? "" : " from " + device_.pcap),
                true);
  }
}

}  // namespace rgbdt
