#include <algorithm>
#include <set>

#include "services/doctor/checks.h"

namespace rgbdt {
namespace {

std::string Wanted(const CameraDevice& device) {
  if (!device.serial.empty()) return "serial number " + device.serial;
  return device.address.empty() ? "id " + device.id : "address " + device.address;
}

std::string Describe(const GvcpDevice& device) {
  return device.vendor + " " + device.model + ", serial number " + device.serial + ", " +
         device.mac;
}

std::string WithPrefix(std::uint32_t address, std::uint32_t mask) {
  return AddressText(address) + "/" + std::to_string(PrefixLength(mask));
}

std::string AddressesText(const NetworkInterface* interface) {
  std::string text;
  if (interface == nullptr) return "no address";
  for (const InterfaceAddress& own : interface->addresses) {
    text += (text.empty() ? "" : ", ") + WithPrefix(own.address, own.mask);
  }
  return text.empty() ? "no address" : text;
}

// A camera whose mask leaves no room for another host, or all, gets a common one.
std::uint32_t MaskOf(const GvcpDevice& device) {
  const int length = PrefixLength(device.mask);
  return length == 0 || length > 30 ? 0xffffff00 : device.mask;
}

// An address for this machine in the camera's subnet: the first below the camera's, going round,
// that is no camera's, no router's and not the subnet's first or last.
std::uint32_t FreeAddress(const GvcpDevice& camera, const CameraNetwork& network) {
  std::set<std::uint32_t> taken{camera.gateway};
  for (const FoundGvcpDevice& found : network.found) taken.insert(found.device.address);
  const std::uint32_t hosts = ~MaskOf(camera), subnet = camera.address & MaskOf(camera);
  std::uint32_t host = camera.address & hosts;
  for (int i = 0; i < 256; ++i) {
    host = (host - 1) & hosts;
    if (host != 0 && host != hosts && taken.count(subnet | host) == 0) break;
  }
  return subnet | host;
}

Finding OutOfReach(const CameraFacts& camera, const CameraNetwork& network) {
  const GvcpDevice& device = camera.found->device;
  const std::string at = WithPrefix(device.address, MaskOf(device));
  const NetworkInterface* interface = network.Interface(camera.interface);
  std::string fix = "sudo ip addr add " + WithPrefix(FreeAddress(device, network), MaskOf(device)) +
                    " dev " + camera.interface;
  if (interface != nullptr && !interface->addresses.empty()) {
    fix += "  # or give the camera an address in the subnet of " + AddressesText(interface);
  }
  return Problem("camera " + camera.name,
                 "is there (" + Describe(device) + ") but cannot be reached: it has " + at + ", " +
                     camera.interface + " where it answers has " + AddressesText(interface),
                 fix);
}

Finding WrongWay(const CameraFacts& camera) {
  const std::string address = AddressText(camera.found->device.address);
  return Problem(
      "camera " + camera.name,
      "answers on " + camera.interface + " as " + address + ", but the route there " +
          (camera.next_interface.empty() ? "is missing" : "leads to " + camera.next_interface) +
          ": two interfaces in one subnet?",
      "sudo ip route add " + address + "/32 dev " + camera.interface);
}

Finding Held(const CameraFacts& camera, const CameraNetwork& network) {
  const std::string check = "camera " + camera.name;
  const std::string what = "answers at " + AddressText(camera.found->device.address) +
                           ", but another program holds its control channel";
  const std::vector<Holder>& programs = network.camera_programs;
  if (programs.empty()) {
    return Problem(check, what + ", perhaps on another machine",
                   "close it (a vendor's viewer?); a camera whose program died frees itself after "
                   "some seconds");
  }
  std::string fix = "kill";
  for (const Holder& program : programs) fix += " " + std::to_string(program.pid);
  const bool ours = std::all_of(programs.begin(), programs.end(), [](const Holder& program) {
    return program.name == "rgbdt-camera";
  });
  if (ours) {
    return Warning(
        check,
        what + ", likely " + HoldersText(programs) + ": well, unless you mean to start another",
        fix);
  }
  return Problem(check, what + ", likely " + HoldersText(programs), fix);
}

Finding Missing(const CameraFacts& camera, const CameraNetwork& network) {
  std::string who;
  for (const FoundGvcpDevice& found : network.found) {
    who += (who.empty() ? "" : "; ") + Describe(found.device) + " at " +
           AddressText(found.device.address) + " on " + found.interface;
  }
  return Problem("camera " + camera.name,
                 "nobody answers who has " + Wanted(camera.device) + "; " +
                     (who.empty() ? "no GigE Vision camera answers at all" : "there is " + who),
                 "ip -br link  # is its interface UP? Check power, cable and firewall, or the "
                 "rig's camera.device");
}

// What hides a camera of another subnet.
Finding Filtered(const std::vector<std::string>& interfaces) {
  std::string names, settings;
  for (const std::string& name : interfaces) {
    names += (names.empty() ? "" : ", ") + name;
    settings += " net.ipv4.conf." + name + ".rp_filter=0";
  }
  return Warning(
      "camera search",
      "the kernel's reverse-path filter of " + names +
          " may hide a camera that lies in another subnet",
      "sudo sysctl -w net.ipv4.conf.all.rp_filter=0" + settings + "  # then run this again");
}

Finding CheckCamera(const CameraFacts& camera, const CameraNetwork& network) {
  const std::string check = "camera " + camera.name;
  if (camera.by_usb) return Ok(check, "is plugged in by USB");
  if (!camera.found) return Missing(camera, network);
  const GvcpDevice& device = camera.found->device;
  const NetworkInterface* interface = network.Interface(camera.interface);
  if (interface == nullptr || !WithinReach(device, *interface)) return OutOfReach(camera, network);
  if (camera.next_interface != camera.interface && !interface->loopback) return WrongWay(camera);
  if (camera.control == GvcpControl::kHeld) return Held(camera, network);
  const std::string where = " at " + AddressText(device.address) + " on " + camera.interface;
  if (camera.control == GvcpControl::kNoAnswer) {
    return Problem(check,
                   "answers the search" + where +
                       " but not when it is asked itself: a firewall, or "
                       "two devices with one address",
                   "ping -c 1 " + AddressText(device.address) + "; ip neigh show " +
                       AddressText(device.address) + "  # the camera's MAC is " + device.mac);
  }
  return Ok(check, "answers" + where + " (" + Describe(device) + ")");
}

}  // namespace

Findings CheckCameras(const CameraNetwork& network) {
  Findings findings;
  bool missing = false;
  for (const CameraFacts& camera : network.cameras) {
    findings.push_back(CheckCamera(camera, network));
    missing = missing || (!camera.found && !camera.by_usb);
  }
  if (missing && !network.filtered.empty()) findings.push_back(Filtered(network.filtered));
  return findings;
}

}  // namespace rgbdt
