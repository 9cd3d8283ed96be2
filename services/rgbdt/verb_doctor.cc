#include <algorithm>
#include <filesystem>
#include <memory>
#include <set>

#include "calib/files/schema/rig_file.h"
#include "calib/model/errors.h"
#include "services/bus/bus.h"
#include "services/doctor/checks.h"
#include "services/drivers/packets/packet_source.h"
#include "services/rgbdt/verbs.h"
#include "services/up/rig_programs.h"

namespace rgbdt {
namespace {

struct DoctorFlags {
  std::string rig, url;
  double listen = 3;  // [s]
};

Findings CheckBus(const SystemRoots& roots, const std::string& text,
                  const std::vector<NetworkInterface>& interfaces) {
  const BusUrl url = ParseBusUrl(CompleteUrl(text));
  if (!url.error.empty()) return CheckBusUrl(url, {});
  const MulticastFacts multicast = GatherMulticast(url.group, interfaces);
  Findings findings = CheckBusUrl(url, multicast.route);
  findings.push_back(CheckMulticast(multicast));
  findings.push_back(CheckPort(GatherPort(roots, url.port, "LCM", true)));
  if (url.ttl > 0) findings.push_back(CheckReassembly(ReassemblyFailures()));
  if (url.ttl == 0) findings.push_back(CheckFirewall(GatherFirewall(url.port, interfaces)));
  return findings;
}

Findings CheckMachine(const SystemRoots& roots, const std::string& url,
                      const std::vector<NetworkInterface>& interfaces) {
  Findings findings{CheckBuffer(GatherBuffer(roots))};
  Append(CheckBus(roots, url, interfaces), &findings);
  findings.push_back(CheckClock(GatherClock(roots)));
  findings.push_back(CheckDisk(GatherDisk(std::filesystem::current_path())));
  return findings;
}

// Whether what says how to decode its packets can be read; and the port that they come to.
Findings CheckPacketLidar(const SystemRoots& roots, const PacketLidarDevice& device) {
  try {
    const PacketSource reads(device);
  } catch (const InputError& e) {
    return {Problem(MakerOf(device.make), e.what())};
  }
  if (!device.pcap.empty()) return {};
  return {CheckPort(GatherPort(roots, device.port, MakerOf(device.make), false))};
}

Findings CheckLidar(const SystemRoots& roots, const LidarSpec& lidar,
                    const std::vector<NetworkInterface>& interfaces) {
  Findings findings;
  if (const auto* hokuyo = std::get_if<HokuyoDevice>(&lidar.device)) {
    findings.push_back(CheckHokuyo(GatherHokuyo(*hokuyo, interfaces)));
  } else if (const auto* velodyne = std::get_if<VelodyneDevice>(&lidar.device)) {
    if (velodyne->pcap.empty()) {
      findings.push_back(CheckPort(GatherPort(roots, velodyne->port, "Velodyne", false)));
    }
  } else if (const auto* packets = std::get_if<PacketLidarDevice>(&lidar.device)) {
    Append(CheckPacketLidar(roots, *packets), &findings);
  }
  if (lidar.turned_scanner && lidar.turned_scanner->motor) {
    findings.push_back(CheckSerial(GatherSerial(roots, lidar.turned_scanner->motor->port)));
  }
  return findings;
}

Findings CheckRig(const SystemRoots& roots, const std::string& file,
                  const std::vector<NetworkInterface>& interfaces) {
  try {
    const Rig rig = ReadRig(file, LensNeed::kMayBeUnknown);
    Findings findings = CheckLidar(roots, rig.lidar, interfaces);
    const CameraNetwork network = GatherCameras(roots, rig, interfaces);
    Append(CheckCameras(network), &findings);
    Append(CheckPackets(network), &findings);
    Append(CheckLinks(network), &findings);
    return findings;
  } catch (const InputError& e) {
    return {Problem("rig", e.what())};
  }
}

// The processes of a session, or of a drive where one of those speaks. What is simulated has no
// drivers.
std::vector<std::string> ExpectedOf(const Rig& rig, const BusFacts& facts) {
  const std::vector<std::string> of_a_drive = SpeakersOf(rig, {Role::kDrive});
  const bool drives = std::any_of(of_a_drive.begin(), of_a_drive.end(),
                                  [&](const std::string& name) { return facts.Speaks(name); });
  std::set<Role> roles{Role::kBoth, drives ? Role::kDrive : Role::kSession};
  if (!facts.Speaks("simulator")) roles.insert(Role::kDriver);
  return SpeakersOf(rig, roles);
}

std::vector<std::string> ExpectedOf(const std::string& rig_file, const BusFacts& facts) {
  if (rig_file.empty()) return {};
  try {
    return ExpectedOf(ReadRig(rig_file, LensNeed::kMayBeUnknown), facts);
  } catch (const InputError&) {  // CheckRig tells
    return {};
  }
}

// Who speaks on a bus that can be opened; where it cannot, CheckBus tells.
Findings CheckSpeakers(const DoctorFlags& flags) {
  try {
    const BusFacts facts = GatherBus(flags.url, flags.listen);
    return CheckProcesses(facts, ExpectedOf(flags.rig, facts));
  } catch (const InputError&) {
    return {};
  }
}

// Whether the bus can be opened, and what is sent there comes back.
bool CanBeHeard(const Findings& findings) {
  return std::none_of(findings.begin(), findings.end(), [](const Finding& finding) {
    return finding.level == Finding::Level::kProblem &&
           (finding.check == "LCM URL" || finding.check == "multicast");
  });
}

int RunDoctor(const DoctorFlags& flags) {
  const SystemRoots roots;
  const std::vector<NetworkInterface> interfaces = ListInterfaces();
  Findings findings = CheckMachine(roots, flags.url, interfaces);
  if (flags.listen > 0 && CanBeHeard(findings)) Append(CheckSpeakers(flags), &findings);
  if (!flags.rig.empty()) Append(CheckRig(roots, flags.rig, interfaces), &findings);
  std::fputs(FindingsText(findings).c_str(), stdout);
  return EndsWith(!HasProblem(findings));
}

}  // namespace

void AddDoctor(CommandLine* program) {
  auto flags = std::make_shared<DoctorFlags>();
  CommandLine* verb = program->Verb(
      "doctor",
      "Looks for what goes or would go wrong with the live system, on this machine,\n"
      "with the processes on the bus and with a rig's devices, and names the command\n"
      "that mends it.\n"
      "Example: rgbdt doctor --rig rig.textproto",
      [flags] { return RunDoctor(*flags); });
  verb->Ends(ExitCode::kFailed, "failed, or there is a problem");
  verb->Option("--rig", &flags->rig, "rig.textproto; default: only the machine is looked at");
  verb->Within("--listen", &flags->listen, 0, 60,
               "seconds to listen to the processes on the bus; 0: not at all");
  verb->Option("--lcm-url", &flags->url, "the bus; default: LCM_DEFAULT_URL");
}

}  // namespace rgbdt
