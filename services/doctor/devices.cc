#include <fcntl.h>
#include <grp.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>

#include "calib/model/descriptor.h"
#include "services/doctor/facts.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;

bool IsSerialName(const std::string& name) {
  for (const char* begin : {"ttyUSB", "ttyACM", "ttyAMA", "ttyTHS"}) {
    if (name.rfind(begin, 0) == 0) return true;
  }
  return false;
}

std::vector<std::string> SerialPorts() {
  std::vector<std::string> ports;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator("/dev", error)) {
    if (IsSerialName(entry.path().filename())) ports.push_back(entry.path());
  }
  std::sort(ports.begin(), ports.end());
  return ports;
}

// Another program may have it for itself without a descriptor that this user may see.
int OpenError(const std::string& port) {
  const Descriptor tty(open(port.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!tty) return errno;
  return flock(tty.get(), LOCK_EX | LOCK_NB) == 0 ? 0 : errno;
}

void ReadMode(const std::string& port, SerialFacts* facts) {
  struct stat mode {};
  if (stat(port.c_str(), &mode) != 0) return;
  constexpr mode_t kBoth = S_IRGRP | S_IWGRP;
  facts->is_tty = S_ISCHR(mode.st_mode);
  facts->group_may = (mode.st_mode & kBoth) == kBoth;
  const group* owner = getgrgid(mode.st_gid);
  facts->group = owner != nullptr ? owner->gr_name : std::to_string(mode.st_gid);
}

}  // namespace

SerialFacts GatherSerial(const SystemRoots& roots, const std::string& port) {
  SerialFacts facts;
  facts.port = port;
  facts.others = SerialPorts();
  if (faccessat(AT_FDCWD, port.c_str(), R_OK | W_OK, AT_EACCESS) != 0) facts.access_error = errno;
  ReadMode(port, &facts);
  if (facts.access_error != 0 || !facts.is_tty) return facts;
  std::error_code error;  // /dev/serial/by-id/... is a link, and descriptors name where it leads
  facts.holders = HoldersOf(roots, {fs::canonical(port, error).string()});
  if (facts.holders.empty()) facts.open_error = OpenError(port);
  return facts;
}

HokuyoFacts GatherHokuyo(const HokuyoDevice& device,
                         const std::vector<NetworkInterface>& interfaces) {
  HokuyoFacts facts;
  facts.device = device;
  facts.answer = ProbeTcp(device.address, device.port);
  std::uint32_t address = 0;
  if (!ParseAddress(device.address, &address)) return facts;
  facts.interface = InterfaceInSubnet(address, interfaces);
  facts.on_link = !facts.interface.empty();
  if (facts.on_link) return facts;
  // The way to everywhere else, often wireless, is rather not where the scanner's cable ends.
  const std::string elsewhere = RouteTo(address).interface;
  for (const NetworkInterface& interface : interfaces) {
    if (!interface.up || interface.loopback) continue;
    if (facts.interface.empty() || facts.interface == elsewhere) facts.interface = interface.name;
  }
  return facts;
}

}  // namespace rgbdt
