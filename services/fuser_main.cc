#include "services/command_line/command_line.h"
#include "services/nodes/fuser_node.h"
#include "services/runtime/process.h"

int main(int argc, char** argv) {
  rgbdt::CommandLine line(
      "rgbdt-fuser",
      "CLOUD and images through the calibration to RGBDT_CLOUD. A calibration that is not to be\n"
      "used, or was made with another rig, is refused.\n"
      "Example: rgbdt-fuser --lcm-url 'udpm://239.255.76.67:7667?ttl=0'");
  rgbdt::BusFlags bus;
  line.Bus(&bus.url, &bus.key);
  bool correct_ranges = false;
  line.Flag("--correct-ranges", &correct_ranges,
            "puts points where they truly are, by what the calibration found the LIDAR's ranges\n"
            "and beams to be off by");
  bool anyway = false;
  line.Flag("--anyway", &anyway,
            "use calibrations although their verdict is `do not use`, or the rig is another");
  bool follow = false;
  line.Flag(
      "--follow-monitor", &follow,
      "carries a camera that has moved along with what rgbdt-monitor says of its mount, as far\n"
      "as the rig file's follow lets it (1 degree and 30 mm, where it does not say); each\n"
      "change is said");
  return line.Run(argc, argv, [&] {
    rgbdt::FuserNode node(correct_ranges ? rgbdt::FuserNode::Ranges::kCorrected
                                         : rgbdt::FuserNode::Ranges::kAsMeasured,
                          anyway ? rgbdt::Use::kAnyway : rgbdt::Use::kIfSound,
                          follow ? rgbdt::FuserNode::Follow::kYes : rgbdt::FuserNode::Follow::kNo);
    return rgbdt::RunOnLcm(node, bus);
  });
}
