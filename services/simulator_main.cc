#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>

#include "calib/files/atomic_file.h"
#include "calib/files/schema/rig_file.h"
#include "calib/files/session/session_dir.h"
#include "calib/model/version.h"
#include "services/nodes/simulator_node.h"
#include "services/runtime/process.h"

int main(int argc, char** argv) {
  CLI::App app{
      "The paper's rig, simulated: a turned scanner, a colour and a thermal camera, a board that\n"
      "is carried about. Waits for rgbdt-session.\n"
      "Example: rgbdt-simulator --seed 3 --scene night --rig out/rig.textproto",
      "rgbdt-simulator"};
  std::string url;
  std::string rig_file;
  std::string truth_file;
  double speed = 1;
  rgbdt::simulate::Options options;
  app.add_option("--lcm-url", url, "the bus; default: LCM_DEFAULT_URL");
  app.add_option("--seed", options.seed, "of everything random")->capture_default_str();
  app.add_option("--scene", options.scene, "outdoor, indoor or night")
      ->transform(CLI::CheckedTransformer(rgbdt::simulate::kSceneNames));
  app.add_option("--speed", speed, "simulated seconds per second")
      ->check(CLI::Range(0.01, 1000.0))
      ->capture_default_str();
  app.add_option("--rig", rig_file, "write the rig (with its hand-measured guesses) here first");
  app.add_option("--truth", truth_file, "keep the truth here; no process reads it");
  app.set_version_flag("--version", rgbdt::Version());
  CLI11_PARSE(app, argc, argv);
  try {
    rgbdt::SimulatorNode node(options, speed, [&](const rgbdt::Truth& truth) {
      if (!truth_file.empty()) rgbdt::WriteTruth(truth_file, truth);
    });
    if (!rig_file.empty()) {
      rgbdt::WriteFileAtomically(rig_file, rgbdt::PrintRig(node.simulator().rig()));
    }
    return rgbdt::RunOnLcm(node, url);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "rgbdt-simulator: %s\n", e.what());
    return 1;
  }
}
