#include "calib/files/atomic_file.h"
#include "calib/files/schema/rig_file.h"
#include "calib/files/session/session_dir.h"
#include "services/command_line/command_line.h"
#include "services/runtime/process.h"
#include "services/simulator/simulator_node.h"

int main(int argc, char** argv) {
  rgbdt::CommandLine line(
      "rgbdt-simulator",
      "The paper's rig, simulated: a turned scanner, a colour and a thermal camera, a board that\n"
      "is carried about. Waits for rgbdt-session.\n"
      "Example: rgbdt-simulator --seed 3 --scene night --rig out/rig.textproto");
  rgbdt::BusFlags bus;
  std::string rig_file;
  std::string truth_file;
  double speed = 1;
  rgbdt::simulate::Options options;
  line.Bus(&bus.url, &bus.key);
  line.Option("--seed", &options.seed, "of everything random");
  line.Choice("--scene", &options.scene, rgbdt::simulate::kSceneNames, "");
  line.Within("--speed", &speed, 0.01, 1000.0, "simulated seconds per second");
  line.Option("--rig", &rig_file, "write the rig (with its hand-measured guesses) here first");
  line.Option("--truth", &truth_file, "keep the truth here; no process reads it");
  return line.Run(argc, argv, [&] {
    rgbdt::SimulatorNode node(options, speed, [&](const rgbdt::Truth& truth) {
      if (!truth_file.empty()) rgbdt::WriteTruth(truth_file, truth);
    });
    if (!rig_file.empty()) {
      rgbdt::WriteFileAtomically(rig_file, rgbdt::PrintRig(node.simulator().rig()));
    }
    return rgbdt::RunOnLcm(node, bus);
  });
}
