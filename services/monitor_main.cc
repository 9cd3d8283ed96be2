#include <filesystem>
#include <optional>

#include "calib/files/schema/calibration_file.h"
#include "calib/files/schema/rig_file.h"
#include "calib/model/time.h"
#include "services/command_line/command_line.h"
#include "services/nodes/monitor_node.h"
#include "services/runtime/process.h"

namespace {

std::optional<rgbdt::GivenCalibration> ReadGiven(const std::string& session) {
  if (session.empty()) return std::nullopt;
  const std::filesystem::path folder(session);
  const std::filesystem::path rig = folder / "rig.textproto";
  const std::filesystem::path calibration = folder / "calibration.textproto";
  return rgbdt::GivenCalibration{rgbdt::ReadRig(rig),
                                 rgbdt::ReadCalibration(calibration),
                                 {calibration.string(), rig.string()}};
}

}  // namespace

int main(int argc, char** argv) {
  rgbdt::CommandLine line(
      "rgbdt-monitor",
      "Watches whether each camera still sits where its calibration says, by whatever stands\n"
      "about, without a target: MOUNT_CHECK, in its status and on the viewer's page. With SESSION\n"
      "it sends that session's rig and calibration, too: LIDAR, cameras, monitor, fuser and "
      "viewer\n"
      "are then all that a drive needs.\n"
      "Example: rgbdt-monitor out/session --lcm-url 'udpm://239.255.76.67:7667?ttl=0'");
  rgbdt::BusFlags bus;
  std::string session;
  line.Option("SESSION", &session,
              "folder with rig.textproto and calibration.textproto to send; default: both come\n"
              "over the bus");
  line.Bus(&bus.url, &bus.key);
  double every_s = 2;
  line.Within("--every", &every_s, 0, 3600,
              "seconds between the sweeps that are looked at; 0: all of them");
  return line.Run(argc, argv, [&] {
    rgbdt::MonitorOptions options;
    options.every = rgbdt::FromSeconds(every_s);
    rgbdt::MonitorNode node(options, ReadGiven(session));
    return rgbdt::RunOnLcm(node, bus);
  });
}
