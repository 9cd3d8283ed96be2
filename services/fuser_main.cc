#include "services/command_line/command_line.h"
#include "services/nodes/fuser_node.h"
#include "services/runtime/process.h"

int main(int argc, char** argv) {
  rgbdt::CommandLine line(
      "rgbdt-fuser",
      "CLOUD and images through the calibration to RGBDT_CLOUD. A calibration that is not to be\n"
      "used, or was made with another rig, is refused.\n"
      "Example: rgbdt-fuser --lcm-url 'udpm://239.255.76.67:7667?ttl=0'");
  std::string url;
  line.Option("--lcm-url", &url, "the bus; default: LCM_DEFAULT_URL");
  bool correct_ranges = false;
  line.Flag("--correct-ranges", &correct_ranges,
            "puts points where they truly are, by what the calibration found the LIDAR's ranges\n"
            "and beams to be off by");
  bool anyway = false;
  line.Flag("--anyway", &anyway,
            "use calibrations although their verdict is `do not use`, or the rig is another");
  return line.Run(argc, argv, [&] {
    rgbdt::FuserNode node(correct_ranges ? rgbdt::FuserNode::Ranges::kCorrected
                                         : rgbdt::FuserNode::Ranges::kAsMeasured,
                          anyway ? rgbdt::Use::kAnyway : rgbdt::Use::kIfSound);
    return rgbdt::RunOnLcm(node, url);
  });
}
