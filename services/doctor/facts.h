#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/rig.h"
#include "calib/model/session.h"
#include "services/bus/bus.h"
#include "services/bus/bus_url.h"
#include "services/doctor/system.h"
#include "services/drivers/camera/gvcp_discovery.h"
#include "services/drivers/net/network_interfaces.h"
#include "services/drivers/net/tcp_probe.h"

namespace rgbdt {

// What `rgbdt doctor` looks at, gathered here and judged by checks.h.

/// How much a socket may keep for a reader who is busy [byte].
struct BufferFacts {
  std::int64_t largest = 0;
  bool in_container = false;
};
BufferFacts GatherBuffer(const SystemRoots& roots);

/// The way of the bus's messages.
struct MulticastFacts {
  std::uint32_t group = 0;
  Route route;
  std::optional<NetworkInterface> interface;  ///< that the route leads to
  bool loopback_up = false;
  bool came_back = false;  ///< a datagram to the group, which stayed on this machine
};
MulticastFacts GatherMulticast(std::uint32_t group,
                               const std::vector<NetworkInterface>& interfaces);

/// What keeps other machines' datagrams from lcm-logger and lcm-logplayer, which die of forged
/// ones.
struct FirewallFacts {
  int port = 0;               ///< UDP, of the bus
  bool others_reach = false;  ///< an interface besides the loopback is up
  bool readable = false;      ///< the kernel's rules, which are root's to see
  std::string ruleset;        ///< as `nft list ruleset` prints it
};
FirewallFacts GatherFirewall(int port, const std::vector<NetworkInterface>& interfaces);

/// What a process said of itself, once a second, while the bus was listened to.
struct ProcessFacts {
  Status first, last;  ///< the same one where it was heard once
  int heard = 0;
  int fell_back = 0;  ///< how often its numbers did: of two programs of one name nearly each time
};
/// Who is on the bus.
struct BusFacts {
  double seconds = 0;                   ///< listened for
  std::vector<ProcessFacts> processes;  ///< by name
  Malformed malformed;
  LinkReport links;

  bool Speaks(const std::string& process) const;
};
/// Listens for `seconds`. Throws InputError where the bus cannot be opened.
BusFacts GatherBus(const std::string& url, double seconds);

struct ClockFacts {
  bool synchronised = false;
  bool in_container = false;
};
ClockFacts GatherClock(const SystemRoots& roots);

struct DiskFacts {
  std::string folder;
  std::int64_t free_bytes = -1;  ///< for this user; below 0: unknown
};
DiskFacts GatherDisk(const std::string& folder);

/// A UDP port that one of the processes opens.
struct PortFacts {
  int port = 0;
  std::string what;  ///< "Velodyne"
  int error = 0;     ///< errno of opening it; 0: it is free
  std::vector<Holder> holders;
};
/// `shared`: by as many as like, as LCM opens its port.
PortFacts GatherPort(const SystemRoots& roots, int port, const std::string& what, bool shared);

struct SerialFacts {
  std::string port;
  int access_error = 0;    ///< errno: why it may not be read and written; 0: it may
  int open_error = 0;      ///< of opening it, tried where it may be and nobody is seen to hold it
  bool is_tty = false;     ///< a character device; looked at where it exists
  std::string group;       ///< whose members may, where `group_may`
  bool group_may = false;  ///< read and write
  std::vector<Holder> holders;
  std::vector<std::string> others;  ///< serial ports that there are
};
SerialFacts GatherSerial(const SystemRoots& roots, const std::string& port);

struct HokuyoFacts {
  HokuyoDevice device;
  TcpAnswer answer = TcpAnswer::kConnected;
  bool on_link = false;   ///< an interface here is in its subnet
  std::string interface;  ///< that is in its subnet; else a guess: where its cable ends
};
HokuyoFacts GatherHokuyo(const HokuyoDevice& device,
                         const std::vector<NetworkInterface>& interfaces);

/// What a camera sends.
struct StreamRate {
  double bits_per_s = 0;
  double hz = 0;
  bool assumed = false;  ///< the rig does not say how many images a second
};
/// 0 Hz for one that waits for commands.
StreamRate RateOf(const CameraSpec& camera);

/// A camera of the rig that rgbdt-camera serves.
struct CameraFacts {
  std::string name;
  CameraDevice device;
  StreamRate rate;
  bool by_usb = false;
  std::optional<FoundGvcpDevice> found;
  std::string interface;       ///< towards it; empty: unknown, or by USB
  std::string next_interface;  ///< that the kernel's route to the found address leads over
  GvcpControl control = GvcpControl::kNoAnswer;  ///< asked where its address is within reach
};

/// The network that the cameras are on.
struct CameraNetwork {
  std::vector<NetworkInterface> interfaces;
  std::vector<FoundGvcpDevice> found;
  std::vector<std::pair<std::string, int>> mbit_per_s;  ///< interface, speed; those that tell
  std::vector<std::string> filtered;  ///< interfaces that drop what comes from another subnet
  std::vector<Holder> camera_programs;
  std::vector<CameraFacts> cameras;

  const NetworkInterface* Interface(const std::string& name) const;
};
/// Waits for the cameras' answers, half a second, and as long for each one's control.
CameraNetwork GatherCameras(const SystemRoots& roots, const Rig& rig,
                            const std::vector<NetworkInterface>& interfaces);

/// Whether the camera's address and one of the interface's reach each other without a router.
bool WithinReach(const GvcpDevice& camera, const NetworkInterface& interface);

/// Whether it is the one that the rig means.
bool IsDevice(const CameraDevice& wanted, const GvcpDevice& is);

}  // namespace rgbdt
