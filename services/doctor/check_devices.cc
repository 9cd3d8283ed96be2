#include <cerrno>
#include <cstring>

#include "services/doctor/checks.h"

namespace rgbdt {
namespace {

// What runs already and is to: a warning, where its stranger is a problem.
bool AreOurs(const std::vector<Holder>& holders) {
  for (const Holder& holder : holders) {
    if (holder.name.rfind("rgbdt-", 0) != 0) return false;
  }
  return !holders.empty();
}

std::string KillCommand(const std::vector<Holder>& holders) {
  std::string command = "kill";
  for (const Holder& holder : holders) command += " " + std::to_string(holder.pid);
  return command;
}

std::string Join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

Finding NoSerialPort(const SerialFacts& facts) {
  const std::string others = facts.others.empty() ? "there is no USB serial port at all"
                                                  : "there is " + Join(facts.others);
  return Problem(
      "motor", facts.port + " does not exist; " + others,
      "sudo dmesg | tail  # after plugging the adapter in; or set dynamixel.port in the rig");
}

Finding NoSerialPermission(const SerialFacts& facts) {
  const std::string join = "sudo usermod -aG dialout $USER  # then log in again";
  if (facts.group_may && facts.group != "dialout") {
    return Problem(
        "motor",
        "no permission for " + facts.port + "; members of group " + facts.group + " have it",
        "sudo usermod -aG " + facts.group + " $USER  # then log in again");
  }
  if (facts.group_may) {
    return Problem("motor", "no permission for " + facts.port + "; members of dialout have it",
                   join);
  }
  return Problem(
      "motor", "no permission for " + facts.port + ", nor has any group",
      "sudo chgrp dialout " + facts.port + "; sudo chmod g+rw " + facts.port + "; " + join);
}

Finding SerialHeld(const SerialFacts& facts) {
  const std::string what = facts.port + " is open in " + HoldersText(facts.holders);
  if (AreOurs(facts.holders)) {
    return Warning("motor", what + ": well, unless you mean to start another",
                   KillCommand(facts.holders));
  }
  return Problem("motor", what + ": two programs on one port garble each other",
                 KillCommand(facts.holders));
}

// Another address of the same /24, for this machine.
std::string Neighbour(const std::string& address) {
  std::uint32_t number = 0;
  if (!ParseAddress(address, &number)) return "ADDRESS";
  return AddressText((number & 0xffffff00) | ((number & 0xff) == 100 ? 101 : 100));
}

}  // namespace

Finding CheckPort(const PortFacts& facts) {
  const std::string check = facts.what + " port";
  const std::string port = "UDP port " + std::to_string(facts.port);
  if (facts.error == 0) return Ok(check, port + " can be opened");
  const std::string command = "sudo ss -ulpn 'sport = :" + std::to_string(facts.port) + "'";
  if (facts.error != EADDRINUSE) {
    return Problem(check, port + " cannot be opened: " + std::strerror(facts.error), command);
  }
  if (facts.holders.empty()) {
    return Problem(check, port + " is in use by a program of another user", command);
  }
  const std::string what = port + " is in use by " + HoldersText(facts.holders);
  if (AreOurs(facts.holders)) {
    return Warning(check, what + ": well, unless you mean to start another", command);
  }
  return Problem(check, what + "; stop it: " + KillCommand(facts.holders), command);
}

Finding CheckSerial(const SerialFacts& facts) {
  if (facts.access_error == ENOENT || facts.access_error == ENOTDIR) return NoSerialPort(facts);
  if (facts.access_error != 0) return NoSerialPermission(facts);
  if (!facts.is_tty) {
    return Problem("motor", facts.port + " is no serial port",
                   "ls -l /dev/serial/by-id  # and set dynamixel.port in the rig");
  }
  if (!facts.holders.empty()) return SerialHeld(facts);
  if (facts.open_error == EBUSY || facts.open_error == EWOULDBLOCK) {
    return Problem("motor", facts.port + " is held by a program of another user",
                   "sudo fuser -v " + facts.port);
  }
  if (facts.open_error != 0) {
    return Problem("motor", facts.port + " cannot be opened: " + std::strerror(facts.open_error),
                   "sudo dmesg | tail  # after unplugging the adapter and plugging it in again");
  }
  return Ok("motor", facts.port + " can be opened");
}

Finding CheckHokuyo(const HokuyoFacts& facts) {
  const std::string check = "Hokuyo";
  const std::string address = facts.device.address;
  const std::string port = "port " + std::to_string(facts.device.port);
  const std::string by = facts.interface.empty() ? "eth0" : facts.interface;
  switch (facts.answer) {
    case TcpAnswer::kConnected:
      return Ok(check, address + " " + port + " answers");
    case TcpAnswer::kRefused:
      return Problem(check,
                     "something is at " + address + " but refuses " + port +
                         ": not the scanner, or it is still starting",
                     "ip neigh show " + address + "  # whose MAC is it?");
    case TcpAnswer::kBadAddress:
      return Problem(check, "\"" + address + "\" is no address, and no name that is known here",
                     "set lidar.hokuyo.address in the rig; the factory's is 192.168.0.10");
    default:
      break;
  }
  if (!facts.on_link) {
    return Problem(check, address + " is out of reach: no interface here is in its subnet",
                   "sudo ip addr add " + Neighbour(address) + "/24 dev " + by +
                       "  # the interface where its cable ends");
  }
  return Problem(check,
                 "nobody answers at " + address + " " + port +
                     " within 1 s: no power, no cable, another address, or a firewall",
                 "ping -c 1 " + address + "; ip -br link show " + by + "  # is it UP?");
}

}  // namespace rgbdt
