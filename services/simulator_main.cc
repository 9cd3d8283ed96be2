#include <CLI/CLI.hpp>
#include <chrono>
#include <map>

#include "calib/files/atomic_file.h"
#include "calib/files/schema/rig_file.h"
#include "calib/files/session/session_dir.h"
#include "calib/model/errors.h"
#include "calib/model/version.h"
#include "services/nodes/simulator_node.h"
#include "services/runtime/process.h"

namespace {

using rgbdt::Utime;

// Simulated time against the steady clock: what is due is published, `speed` times faster. After
// time stood still, or rendering took long, it goes on from there and does not catch up: a burst
// would fill the receivers' queues (lcm-logger's holds 30 messages).
class Pacer {
 public:
  explicit Pacer(double speed) : speed_(speed) {}

  bool IsDue(Utime due) {
    const auto now = std::chrono::steady_clock::now();
    const double late_s =
        std::chrono::duration<double>(now - wall_).count() - rgbdt::ToSeconds(due - sim_) / speed_;
    if (late_s < 0 && late_s > -10) return false;
    if (late_s > 0.02 || late_s <= -10) {
      wall_ = now;
      sim_ = due;
    }
    return true;
  }

 private:
  double speed_;
  std::chrono::steady_clock::time_point wall_;
  Utime sim_ = 0;
};

}  // namespace

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
    rgbdt::SimulatorNode node(options);
    if (!rig_file.empty()) {
      rgbdt::WriteFileAtomically(rig_file, rgbdt::PrintRig(node.simulator().rig()));
    }
    Pacer pacer(speed);
    std::size_t views = 0;
    return rgbdt::RunOnLcm(node, url, [&](rgbdt::NodeRunner& runner) {
      while (node.NextDue() && pacer.IsDue(*node.NextDue())) runner.Publish(node.TakeNext());
      const rgbdt::Truth& truth = node.simulator().truth();
      if (!truth_file.empty() && truth.lidar_from_target.size() != views) {
        rgbdt::WriteTruth(truth_file, truth);
        views = truth.lidar_from_target.size();
      }
      return true;
    });
  } catch (const std::exception& e) {
    std::fprintf(stderr, "rgbdt-simulator: %s\n", e.what());
    return 1;
  }
}
