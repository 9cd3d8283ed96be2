#include <algorithm>
#include <cctype>
#include <cstdlib>

#include "services/doctor/facts.h"

namespace rgbdt {
namespace {

constexpr double kAssumedHz = 30;

int BytesPerPixel(PixelFormat format) {
  if (format == PixelFormat::kMono16) return 2;
  return format == PixelFormat::kBgr8 ? 3 : 1;
}

// Aravis writes an id as vendor-model-serial and puts other characters in for some.
std::string LettersAndDigits(const std::string& text) {
  std::string kept;
  for (const char c : text) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) kept += c;
  }
  return kept;
}

bool IsId(const std::string& id, const GvcpDevice& is) {
  const std::string wanted = LettersAndDigits(id);
  const std::string serial = is.serial;
  for (const std::string& name :
       {is.vendor + is.model + serial, is.vendor + serial, is.user_name, is.mac}) {
    if (!name.empty() && LettersAndDigits(name) == wanted) return true;
  }
  return false;
}

std::vector<std::uint32_t> NamedAddresses(const Rig& rig) {
  std::vector<std::uint32_t> addresses;
  for (const CameraSpec& camera : rig.cameras) {
    std::uint32_t address = 0;
    if (camera.device && ParseAddress(camera.device->address, &address)) {
      addresses.push_back(address);
    }
  }
  return addresses;
}

// Of two interfaces that hear it, the one that it can be reached by.
std::optional<FoundGvcpDevice> Find(const CameraDevice& wanted, const CameraNetwork& network) {
  std::optional<FoundGvcpDevice> found;
  for (const FoundGvcpDevice& candidate : network.found) {
    if (!IsDevice(wanted, candidate.device)) continue;
    const NetworkInterface* interface = network.Interface(candidate.interface);
    if (!found || (interface != nullptr && WithinReach(candidate.device, *interface))) {
      found = candidate;
    }
  }
  return found;
}

bool IsUsb(const CameraDevice& device, const std::vector<std::string>& serials) {
  return std::any_of(serials.begin(), serials.end(), [&](const std::string& serial) {
    if (!device.serial.empty()) return serial == device.serial;
    const std::string id = LettersAndDigits(device.id), end = LettersAndDigits(serial);
    return !end.empty() && id.size() >= end.size() &&
           id.compare(id.size() - end.size(), end.size(), end) == 0;
  });
}

void LookFor(const CameraNetwork& network, CameraFacts* camera) {
  camera->found = Find(camera->device, network);
  std::uint32_t address = 0;
  if (camera->found) {
    camera->interface = camera->found->interface;
    address = camera->found->device.address;
    camera->next_interface = RouteTo(address).interface;
    const NetworkInterface* interface = network.Interface(camera->interface);
    if (interface != nullptr && WithinReach(camera->found->device, *interface)) {
      camera->control = AskGvcpControl(address);
    }
  } else if (ParseAddress(camera->device.address, &address)) {
    camera->interface = InterfaceInSubnet(address, network.interfaces);
  }
}

void ReadInterfaces(const SystemRoots& roots, CameraNetwork* network) {
  for (const NetworkInterface& interface : network->interfaces) {
    const auto speed = LinkSpeed(roots, interface.name, interface.index);
    if (speed) network->mbit_per_s.emplace_back(interface.name, *speed);
    if (interface.up && !interface.loopback && ReversePathFilter(roots, interface.name) != 0) {
      network->filtered.push_back(interface.name);
    }
  }
}

}  // namespace

const NetworkInterface* CameraNetwork::Interface(const std::string& name) const {
  const auto found =
      std::find_if(interfaces.begin(), interfaces.end(),
                   [&](const NetworkInterface& interface) { return interface.name == name; });
  return found == interfaces.end() ? nullptr : &*found;
}

bool WithinReach(const GvcpDevice& camera, const NetworkInterface& interface) {
  // On the loopback everything is: Aravis' simulated camera has a mask of its own there.
  if (interface.loopback) return true;
  return std::any_of(interface.addresses.begin(), interface.addresses.end(),
                     [&](const InterfaceAddress& own) {
                       return SameSubnet(own.address, camera.address, own.mask) &&
                              SameSubnet(own.address, camera.address, camera.mask);
                     });
}

bool IsDevice(const CameraDevice& wanted, const GvcpDevice& is) {
  if (!wanted.serial.empty()) return wanted.serial == is.serial;
  if (!wanted.address.empty()) return wanted.address == AddressText(is.address);
  return IsId(wanted.id, is);
}

StreamRate RateOf(const CameraSpec& camera) {
  StreamRate rate;
  if (!camera.device || camera.device->trigger == CameraDevice::Trigger::kSoftware) return rate;
  for (const auto& [name, value] : camera.device->features) {
    // The second is GenICam's old name of it.
    if (name == "AcquisitionFrameRate" || name == "AcquisitionFrameRateAbs") {
      rate.hz = std::strtod(value.c_str(), nullptr);
    }
  }
  rate.assumed = !(rate.hz > 0);
  if (rate.assumed) rate.hz = kAssumedHz;
  rate.bits_per_s = 8.0 * camera.width * camera.height * BytesPerPixel(camera.format) * rate.hz;
  return rate;
}

CameraNetwork GatherCameras(const SystemRoots& roots, const Rig& rig,
                            const std::vector<NetworkInterface>& interfaces) {
  CameraNetwork network;
  network.interfaces = interfaces;
  ReadInterfaces(roots, &network);
  const auto has_device = [](const CameraSpec& camera) { return camera.device.has_value(); };
  if (std::none_of(rig.cameras.begin(), rig.cameras.end(), has_device)) return network;
  network.found = DiscoverGvcp(interfaces, NamedAddresses(rig));
  network.camera_programs = ProcessesNamed(roots, {"rgbdt-camera", "arv-viewer", "arv-camera"});
  const std::vector<std::string> usb_serials = UsbSerials(roots);
  for (const CameraSpec& spec : rig.cameras) {
    if (!spec.device) continue;
    CameraFacts camera;
    camera.name = spec.name;
    camera.device = *spec.device;
    camera.rate = RateOf(spec);
    LookFor(network, &camera);
    camera.by_usb = !camera.found && IsUsb(camera.device, usb_serials);
    network.cameras.push_back(std::move(camera));
  }
  return network;
}

}  // namespace rgbdt
