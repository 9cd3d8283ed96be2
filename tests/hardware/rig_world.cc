// The paper's rig as hardware: a scanner that speaks SCIP, a motor that speaks Dynamixel, and the
// frames that two cameras serve, all of one simulated scene in which the motor really turns the
// scanner. Plays the person, too, who carries the board about. See --help.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <mutex>

#include "calib/files/atomic_file.h"
#include "calib/files/schema/rig_file.h"
#include "calib/files/session/session_dir.h"
#include "calib/simulate/simulator.h"
#include "services/command_line/command_line.h"
#include "services/runtime/process.h"
#include "tests/hardware/dynamixel_peer.h"
#include "tests/hardware/scip_peer.h"

namespace rgbdt {
namespace {

constexpr double kDegree = M_PI / 180;
constexpr int kFrames = 4;                // of one view, each with noise of its own
constexpr double kTicksPerTurn = 501923;  // H54-200-S500-R
constexpr int kSteps = 1440, kFirstStep = 378, kLastStep = 701, kFrontStep = 540, kRpm = 2400;
constexpr double kSpeedDegPerS = 8;
constexpr double kFullIntensity = 65535;

simulate::Options RigOptions(std::uint64_t seed, simulate::Scene scene) {
  simulate::Options options;
  options.seed = seed;
  options.scene = scene;
  simulate::ScannerOptions& scanner = options.scanner;
  scanner.beams = kLastStep - kFirstStep + 1;
  scanner.angle_step_rad = 2 * M_PI / kSteps;
  scanner.first_angle_rad = (kFirstStep - kFrontStep) * scanner.angle_step_rad;
  scanner.beam_period_s = 60.0 / kRpm / kSteps;
  scanner.motor_speed_rad_s = kSpeedDegPerS * kDegree;
  scanner.ticks_per_rad = kTicksPerTurn / (2 * M_PI);
  scanner.zero_ticks = 0;
  return options;
}

// A time of the paper's sunny day is not wanted here: hardware stamps by the machine's clock.
class World {
 public:
  World(const simulate::Options& options, std::filesystem::path folder)
      : simulator_(options),
        folder_(std::move(folder)),
        start_ticks_(options.scanner.sweep_start_rad * options.scanner.ticks_per_rad),
        ticks_per_rad_(options.scanner.ticks_per_rad),
        motor_(MotorOptions()),
        scanner_(ScannerOptions()) {}

  Rig MakeRig() const {
    Rig rig = simulator_.rig();
    rig.name = "hardware";
    rig.lidar.device = HokuyoDevice{"127.0.0.1", scanner_.port()};
    DynamixelDevice motor;
    motor.port = motor_.port();
    motor.baud = 1'000'000;
    motor.from_rad = -30 * kDegree;
    motor.to_rad = 30 * kDegree;
    motor.speed_rad_s = kSpeedDegPerS * kDegree;
    rig.lidar.turned_scanner->motor = motor;
    int number = 0;
    for (CameraSpec& camera : rig.cameras) {
      CameraDevice device;
      device.address = "10.77." + std::to_string(++number) + ".2";
      device.features = {{"AcquisitionFrameRate", "2"}};
      camera.device = device;
    }
    return rig;
  }

  // Carries the board to its place.
  void ShowView(int index, const std::string& name) {
    const std::lock_guard<std::mutex> lock(mutex_);
    simulator_.ShowView(index, name);
    ShowFrames(index);
  }

  // What the cameras see now: files that are replaced whole.
  void ShowFrames(int index) const {
    for (const CameraSpec& camera : simulator_.rig().cameras) {
      std::string frames;
      for (int i = 0; i < kFrames; ++i) {
        const Image image = simulator_.TakeImage(camera.name, 1 + kFrames * index + i);
        frames.append(reinterpret_cast<const char*>(image.pixels.data),
                      image.pixels.total() * image.pixels.elemSize());
      }
      WriteFileAtomically(folder_ / (camera.name + ".raw"), frames);
    }
  }

  const Truth& truth() const { return simulator_.truth(); }

 private:
  test::DynamixelPeer::Options MotorOptions() const {
    test::DynamixelPeer::Options options;
    options.position = start_ticks_;
    return options;
  }

  ScipPeerOptions ScannerOptions() {
    ScipPeerOptions options;
    options.steps = kSteps;
    options.first_step = kFirstStep;
    options.last_step = kLastStep;
    options.front_step = kFrontStep;
    options.rpm = kRpm;
    options.clock_rate = 1 + 30e-6;
    options.clock_start_ms = 4000;
    options.scan = [this](std::int64_t index, double) { return Scan(index); };
    return options;
  }

  // The line that begins at the scanner's first step, the motor turning as it really does.
  ScipPeerScan Scan(std::int64_t index) {
    const double step_us = 60e6 / kRpm / kSteps;
    const Utime first = scanner_.StepZero(index) + std::llround(kFirstStep * step_us);
    const std::lock_guard<std::mutex> lock(mutex_);
    const LineScan line = simulator_.LineAt(first, [&](double seconds) {
      return motor_.TrueTicksAt(static_cast<double>(first) + 1e6 * seconds) / ticks_per_rad_;
    });
    ScipPeerScan scan;
    for (std::size_t i = 0; i < line.range.size(); ++i) {
      const bool hit = std::isfinite(line.range[i]);
      scan.range_mm.push_back(hit ? static_cast<std::uint32_t>(std::lround(1e3F * line.range[i]))
                                  : 1);
      const double intensity = hit ? kFullIntensity * static_cast<double>(line.intensity[i]) : 0;
      scan.intensity.push_back(static_cast<std::uint32_t>(std::lround(intensity)));
    }
    return scan;
  }

  std::mutex mutex_;  // of the simulator: the scanner asks from a thread of its own
  simulate::Simulator simulator_;
  std::filesystem::path folder_;
  double start_ticks_, ticks_per_rad_;
  test::DynamixelPeer motor_;
  ScipPeer scanner_;  // last: it asks all the others
};

// SESSION_COMMAND next_pose -> done, once the board stands there in all sensors' view.
class WorldNode : public Node {
 public:
  WorldNode(World* world, std::string truth_file)
      : world_(world), truth_file_(std::move(truth_file)) {}

  std::string name() const override { return "world"; }
  std::vector<std::string> Subscriptions() const override { return {"SESSION_COMMAND"}; }

  Messages Handle(const Message& message) override {
    const auto& command = std::get<SessionCommand>(message);
    if (command.verb == SessionVerb::kReset) views_ = 0;
    if (command.verb != SessionVerb::kNextPose) return {};
    world_->ShowView(views_++, command.view);
    if (!truth_file_.empty()) WriteTruth(truth_file_, world_->truth());
    SessionEvent event;
    event.command = command.command;
    event.source = "world";
    event.text = "the board stands";
    event.fraction = 1;
    return {event};
  }

  Status GetStatus() const override {
    Status status;
    status.ready = true;
    status.text = "shows view " + std::to_string(views_);
    return status;
  }

 private:
  World* world_;
  std::string truth_file_;
  int views_ = 0;
};

}  // namespace
}  // namespace rgbdt

int main(int argc, char** argv) {
  rgbdt::CommandLine line(
      "rig_world",
      "Hardware that is simulated down to its protocols: SCIP, Dynamixel, and frames for two\n"
      "fake_camera processes, <camera>.raw in --folder. Answers next_pose.\n"
      "Example: rig_world --folder out/world --rig out/rig.textproto");
  rgbdt::BusFlags bus;
  std::string folder = ".";
  std::string rig_file;
  std::string truth_file;
  std::uint64_t seed = 1;
  rgbdt::simulate::Scene scene = rgbdt::simulate::Scene::kOutdoor;
  line.Option("--folder", &folder, "where the frames go");
  line.Required("--rig", &rig_file, "write the rig here, once its devices answer");
  line.Option("--truth", &truth_file, "keep the truth here; no process reads it");
  line.Option("--seed", &seed, "of everything random");
  line.Choice("--scene", &scene, rgbdt::simulate::kSceneNames, "outdoor, indoor or night");
  line.Bus(&bus.url, &bus.key);
  return line.Run(argc, argv, [&] {
    rgbdt::World world(rgbdt::RigOptions(seed, scene), folder);
    world.ShowFrames(0);  // of the scene without the board
    rgbdt::WriteFileAtomically(rig_file, rgbdt::PrintRig(world.MakeRig()));
    rgbdt::WorldNode node(&world, truth_file);
    return rgbdt::RunOnLcm(node, bus);
  });
}
