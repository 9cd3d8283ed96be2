#include <cerrno>
#include <cstdio>
#include <cstring>

#include "calib/model/text.h"
#include "services/bus/multicast.h"
#include "services/doctor/checks.h"

namespace rgbdt {
namespace {

constexpr double kGigabyte = 1e9;
constexpr double kMinFreeGigabytes = 2, kFullGigabytes = 0.1;
constexpr std::uint32_t kLocalGroups = 0xef000000, kLocalGroupsMask = 0xff000000;  // 239.0.0.0/8

// A command's note is a comment of the shell, so that the line can be pasted as it is.
std::string OnTheHost(bool in_container) {
  return in_container ? "  # on the host: this is a container" : "";
}

std::string RouteCommand(std::uint32_t group) {
  const bool local = SameSubnet(group, kLocalGroups, kLocalGroupsMask);
  return "sudo ip route add " + (local ? "239.0.0.0/8" : AddressText(group) + "/32") + " dev lo";
}

}  // namespace

Finding CheckBuffer(const BufferFacts& facts) {
  const std::string check = "receive buffer";
  const std::string size = std::to_string(facts.largest) + " bytes";
  if (facts.largest >= kReceiveBufferBytes) return Ok(check, size);
  return Problem(
      check,
      "the kernel allows " + size + ", so large messages (images, clouds) get lost under load",
      "sudo sysctl -w net.core.rmem_max=" + std::to_string(kReceiveBufferBytes) +
          OnTheHost(facts.in_container));
}

Findings CheckBusUrl(const BusUrl& url, const Route& route) {
  const std::string check = "LCM URL";
  if (!url.error.empty()) {
    return {Problem(check, "\"" + url.text + "\": " + url.error,
                    "export LCM_DEFAULT_URL='udpm://239.255.76.67:7667?ttl=0'")};
  }
  Findings findings;
  if (url.buffer_bytes >= 0 && url.buffer_bytes < kReceiveBufferBytes) {
    findings.push_back(Warning(
        check,
        "recv_buf_size=" + std::to_string(url.buffer_bytes) +
            " is small: large messages get lost under load",
        "leave recv_buf_size out; rgbdt then takes " + std::to_string(kReceiveBufferBytes)));
  }
  if (url.ttl == 0) {
    findings.push_back(Ok(check, url.text +
                                     ": ttl=0, messages stay on this machine; processes on several "
                                     "machines need ttl=1"));
  } else if (route.interface == "lo") {
    findings.push_back(
        Warning(check,
                "ttl=" + std::to_string(url.ttl) + ", but the route to " + AddressText(url.group) +
                    " leads to lo: other machines hear nothing",
                "sudo ip route replace " + AddressText(url.group) +
                    "/32 dev eth0  # the interface towards them; or ttl=0 in the URL"));
  } else {
    findings.push_back(Warning(
        check,
        "ttl=" + std::to_string(url.ttl) + ": images and clouds, megabytes each, go out by " +
            (route.interface.empty() ? "whatever the route is" : route.interface) +
            " to everybody on that network",
        "ttl=0 in the URL where all processes run on this machine"));
  }
  return findings;
}

Finding CheckMulticast(const MulticastFacts& facts) {
  const std::string check = "multicast";
  const std::string group = AddressText(facts.group);
  const std::string up = facts.loopback_up ? "" : "sudo ip link set lo up; ";
  if (facts.route.error != 0) {
    return Problem(check,
                   "no route to the bus's group " + group + " (" +
                       std::strerror(facts.route.error) + "): no process can open the bus",
                   up + RouteCommand(facts.group) + "; sudo ip link set lo multicast on");
  }
  if (facts.interface && !facts.interface->multicast) {
    const std::string name = facts.interface->name;
    const std::string fix = "sudo ip link set " + name + " multicast on";
    const std::string what =
        "the route to " + group + " leads to " + name + ", which has no multicast switched on";
    return facts.came_back ? Warning(check, what, fix) : Problem(check, what, fix);
  }
  if (!facts.came_back) {
    return Problem(check, "a message to " + group + " did not come back; a firewall may drop it",
                   "sudo nft list ruleset  # what drops " + group + "?");
  }
  return Ok(check, "messages to " + group + " come back" +
                       (facts.interface ? ", by " + facts.interface->name : ""));
}

Finding CheckClock(const ClockFacts& facts) {
  if (facts.synchronised) return Ok("clock", "synchronised");
  return Warning("clock",
                 "not synchronised: images and clouds of several machines, or of a camera with a "
                 "clock of its own, do not fit together",
                 "sudo timedatectl set-ntp true" + OnTheHost(facts.in_container));
}

Finding CheckDisk(const DiskFacts& facts) {
  if (facts.free_bytes < 0)
    return Warning("disk", "cannot tell how much is free in " + facts.folder);
  const double gigabytes = static_cast<double>(facts.free_bytes) / kGigabyte;
  const std::string what = Format("%.1f GB free in ", gigabytes) + facts.folder;
  if (gigabytes >= kMinFreeGigabytes) return Ok("disk", what);
  const std::string fix = "du -xh --max-depth=2 " + facts.folder + " | sort -h | tail";
  if (gigabytes < kFullGigabytes) return Problem("disk", what + ", too little for a view", fix);
  return Warning("disk", what + "; a session or a log of some minutes fills it", fix);
}

Finding CheckReassembly(std::int64_t failures) {
  const std::string check = "network";
  if (failures == 0) return Ok(check, "no datagram lacked a piece since the machine started");
  return Warning(check,
                 std::to_string(failures) +
                     " datagrams larger than a network's MTU lacked a piece and were lost whole "
                     "since the machine started (ReasmFails): a link loses packets",
                 "nstat -az IpReasmFails; rgbdt's own messages are repaired with ttl=1, those of "
                 "other LCM programs are lost: put them on the machine that sends what they need");
}

}  // namespace rgbdt
