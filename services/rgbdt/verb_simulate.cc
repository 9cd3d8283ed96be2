#include <cstdio>
#include <memory>

#include "calib/files/import/board_text.h"
#include "calib/files/schema/rig_file.h"
#include "calib/files/session/session_dir.h"
#include "calib/model/errors.h"
#include "calib/model/text.h"
#include "calib/simulate/imperfections.h"
#include "calib/simulate/simulator.h"
#include "calib/simulate/use_target.h"
#include "services/rgbdt/simulate_log.h"
#include "services/rgbdt/verbs.h"
#include "services/simulator/simulated_sweep.h"
#include "services/simulator/simulator_node.h"

namespace rgbdt {
namespace {

using simulate::Simulator;

struct SimulateFlags {
  const CommandLine* verb = nullptr;  // what was given
  std::string dir;
  std::string target;
  int views = 12;
  std::vector<std::string> picked = {"thermal"};
  std::vector<std::string> further;
  int rings = 0;
  double wave = 0, drive = 0;  // [s]
  bool full_turn = false, scanner_error = false, imperfect = false, board = false;
  simulate::Options options;
};

// Of the turned scanner: how far it turns, and how wrong the rig file is about where it sits.
void SetScanner(const SimulateFlags& flags, simulate::Options* options) {
  const bool of_scanner =
      flags.full_turn || flags.scanner_error || flags.options.scanner.encoder_delay_s != 0;
  if (of_scanner && flags.rings != 0) {
    throw UsageError(
        "--full-turn, --scanner-error and --encoder-delay are of the turned scanner; leave --lidar "
        "out");
  }
  if (flags.full_turn) options->scanner = simulate::FullTurnScanner();
  options->scanner.encoder_delay_s = flags.options.scanner.encoder_delay_s;
  if (!flags.scanner_error) return;
  options->scanner.guess_lever_m = {0.005, -0.005, 0.005};
  options->scanner.guess_tilt_rad = Eigen::Vector3d(0.5, 0.5, -0.5) * simulate::kDegree;
}

// Another board than the usual one.
void SetTarget(const std::string& text, simulate::BoardOptions* board) {
  if (text.empty()) return;
  const Target target = ParseBoard(text);
  if (!target.HasPattern()) {
    throw UsageError("--target " + text + ": only boards with a pattern are simulated");
  }
  simulate::UseTarget(target, board);
}

// Natural scenes have no board unless asked for, and nobody picks corners of none.
void SetScene(SimulateFlags* flags) {
  simulate::NaturalOptions& natural = flags->options.natural;
  if (flags->board && !natural.on) throw UsageError("--board goes with --natural: others have one");
  if (!natural.on) return;
  if (flags->options.scene == simulate::Scene::kNight) {
    throw UsageError("--natural is outdoor or indoor; leave --scene night out");
  }
  natural.board = flags->board;
  // There are edges in a large part of the pixels; an upright one is still placed to 1/16 pixel.
  flags->options.supersampling = 4;
  if (!natural.board) flags->picked.clear();
}

// The LIDAR's cloud from this time on; `now` becomes when it ends.
Cloud TakeCloud(const Simulator& simulator, const simulate::Options& options, Utime* now) {
  const Utime begin = *now;
  if (!options.turned()) {
    *now += FromSeconds(options.livox ? options.livox->seconds : options.spinning->revolution_s);
    return simulator.Revolution(begin);
  }
  *now += simulator.sweep_lines() * simulator.line_period();
  return TakeSweep(simulator, begin);
}

// LIDARs beside the rig's own.
void AddFurtherLidars(const std::vector<std::string>& further, simulate::Options* options) {
  for (const std::string& lidar : further) {
    const auto rings = simulate::kLidarRings.find(lidar);
    if (rings == simulate::kLidarRings.end() || rings->second <= 0) {
      throw UsageError("--further-lidar is \"" + lidar + "\"; expected vlp16, 32, 64 or 128");
    }
    simulate::AddLidar(rings->second, options);
  }
}

// Throws UsageError for what is of views alone.
void RequireOfALog(const SimulateFlags& flags) {
  if (flags.wave > 0 && flags.drive > 0) throw UsageError("--wave and --drive: one of them");
  std::vector<const char*> others{"--views",         "--picked",        "--natural",
                                  "--board",         "--further-lidar", "--full-turn",
                                  "--scanner-error", "--encoder-delay"};
  if (flags.drive > 0) others.push_back("--target");
  for (const char* other : others) {
    if (!flags.verb->Given(other)) continue;
    throw UsageError(std::string(other) + " goes with views, not with the log of a " +
                     (flags.drive > 0 ? "drive" : "waved board") + "; leave it out");
  }
  if (flags.verb->Given("--lidar") && flags.rings <= 0) {
    throw UsageError("a log is of a spinning LIDAR: --lidar vlp16, 32, 64 or 128");
  }
}

// A log in place of views.
int RunLog(SimulateFlags flags) {
  RequireOfALog(flags);
  if (std::filesystem::exists(std::filesystem::path(flags.dir) / "views")) {
    throw InputError(flags.dir + " is a session; a log wants a folder of its own");
  }
  SetTarget(flags.target, &flags.options.board);
  // By its rings; the turned scanner is the views' usual one.
  constexpr int kUsualRings = 32;
  simulate::UseLidar(flags.rings == 0 ? kUsualRings : flags.rings, &flags.options);
  if (flags.imperfect) simulate::MakeImperfect(&flags.options);
  flags.options.natural.on = flags.drive > 0;
  if (flags.wave > 0) {
    SimulateWave(flags.dir, flags.options, flags.wave);
  } else {
    flags.options.supersampling = 4;  // as SetScene has it
    SimulateDrive(flags.dir, flags.options, flags.drive,
                  flags.imperfect ? Clocks::kOff : Clocks::kExact);
  }
  return EndsWith(true);
}

int RunSimulate(SimulateFlags flags) {
  if (flags.wave > 0 || flags.drive > 0) return RunLog(std::move(flags));
  if (flags.views < 1 || flags.views > 9999) {
    throw UsageError("--views is " + std::to_string(flags.views) + "; expected 1 to 9999");
  }
  SetScene(&flags);
  SetTarget(flags.target, &flags.options.board);
  simulate::Options options = flags.options;
  simulate::UseLidar(flags.rings, &options);
  AddFurtherLidars(flags.further, &options);
  SetScanner(flags, &options);
  if (flags.imperfect) simulate::MakeImperfect(&options);
  const std::string off_by = simulate::ImperfectionsText(options);
  Simulator simulator(options);
  Rig rig = simulator.rig();
  for (const std::string& camera : flags.picked) rig.Camera(camera);
  WriteRig(flags.dir, ParseRig(PrintRig(rig), "synthetic rig"));
  Utime now = SimulatorNode::kEpoch;
  for (int i = 0; i < flags.views; ++i) {
    View view;
    char name[16];
    std::snprintf(name, sizeof(name), "%04d", i + 1);
    view.name = name;
    view.heldout = i % 3 == 2;
    std::fprintf(stderr, "[%d/%d] view %s: rendering, sweeping\n", i + 1, flags.views, name);
    simulator.ShowView(i, view.name);
    view.cloud = TakeCloud(simulator, options, &now);
    view.further_clouds = simulator.FurtherRevolutions(view.cloud.sweep_utime);
    now += kMicrosecondsPerSecond;
    for (const CameraSpec& camera : rig.cameras) {
      view.images.push_back(simulator.TakeImage(camera.name, now));
    }
    for (const std::string& camera : flags.picked) {
      view.picks.push_back(simulator.PickCorners(camera, now));
    }
    now += kMicrosecondsPerSecond;
    WriteView(flags.dir, view);
    WriteTruth(std::filesystem::path(flags.dir) / "truth.textproto", simulator.truth(), off_by);
  }
  if (!off_by.empty()) std::printf("drawn, and noted in truth.textproto:\n%s", off_by.c_str());
  std::printf("wrote %s: rig.textproto, %d view%s, truth.textproto\n", flags.dir.c_str(),
              flags.views, flags.views == 1 ? "" : "s");
  if (!options.natural.on || options.natural.board) {
    std::printf("next: rgbdt calibrate %s\n", ForShell(flags.dir).c_str());
  }
  return EndsWith(true);
}

}  // namespace

void AddSimulate(CommandLine* program) {
  auto flags = std::make_shared<SimulateFlags>();
  CommandLine* verb = program->Verb(
      "simulate",
      "Writes a session directory of the synthetic rig, with its truth beside (truth.textproto).\n"
      "Every third view is held out. Or a log: of a board that is waved, or of a drive.\n"
      "Examples: rgbdt simulate out/synthetic --seed 7 --scene night\n"
      "          rgbdt simulate out/drive --drive 20 --scene outdoor",
      [flags] { return RunSimulate(*flags); });
  flags->verb = verb;
  verb->Required("DIR", &flags->dir, "session directory to write");
  verb->Option("--views", &flags->views, "number of views");
  verb->Option("--seed", &flags->options.seed, "of all random numbers");
  verb->Choice("--scene", &flags->options.scene, simulate::kSceneNames, "");
  verb->Choice("--lidar", &flags->rings, simulate::kLidarRings,
               "a turned scanner, a spinning LIDAR by its rings, or a Livox, a second each");
  verb->Option("--further-lidar", &flags->further,
               "a spinning LIDAR beside that one, which sees the board, too: vlp16, 32, 64 or 128; "
               "may be given again");
  verb->Flag("--full-turn", &flags->full_turn,
             "the scanner turns by 360 degrees with a line of 270, as `rgbdt scanner` needs it");
  verb->Flag("--scanner-error", &flags->scanner_error,
             "the rig file's motor_from_scanner is wrong by 5 mm and 0.5 degrees on each axis, "
             "and the clouds are made with it");
  verb->Option("--encoder-delay", &flags->options.scanner.encoder_delay_s,
               "the motor's encoder is stamped so many seconds late");
  verb->Flag("--imperfect", &flags->imperfect,
             "what real rigs are off by, drawn from the seed: lenses, print, ranges (all, of each "
             "ring, of dark surfaces), where beams meet, how wide they are. Of a drive "
             "the cameras' clocks and shutters, too; its calibration.textproto has these and the "
             "true lenses");
  verb->Flag(
      "--natural", &flags->options.natural.on,
      "no board: a street (outdoor) or a room (indoor) as the seed lays it out, with people; "
      "the rig drives on between views");
  verb->Flag("--board", &flags->board, "with --natural: the board stands there, too");
  verb->Within("--wave", &flags->wave, 0, 600,
               "seconds that a board is waved before a spinning LIDAR (32 rings unless --lidar "
               "says otherwise): DIR/wave.lcmlog, for `rgbdt sync`. Cameras' clocks and shutters "
               "are off as the seed draws it");
  verb->Within("--drive", &flags->drive, 0, 3600,
               "seconds that the rig drives, along a street (outdoor) or through a room (indoor): "
               "DIR/drive.lcmlog, for `rgbdt map` and `rgbdt refine`, with its true way beside");
  verb->Option("--target", &flags->target,
               "the board, as rgbdt session's --board: 8x6@0.095,0.85x0.61 or "
               "charuco@11x8,0.1,0.075,5X5_100,1.2192x0.9144 or "
               "aprilgrid@7x5,0.13,0.25,36h11,1.2192x0.9144 or velo2cam@0.16");
  verb->Option("--picked", &flags->picked, "cameras whose corners a person picks");
}

}  // namespace rgbdt
