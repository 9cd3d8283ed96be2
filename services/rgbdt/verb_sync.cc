#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calib/files/atomic_file.h"
#include "calib/files/check_writable.h"
#include "calib/files/image_files.h"
#include "calib/files/schema/calibration_file.h"
#include "calib/model/text.h"
#include "calib/present/pictures/sync_picture.h"
#include "calib/sync/sync.h"
#include "services/posix/clock.h"
#include "services/replay/recording_node.h"
#include "services/replay/telling_node.h"
#include "services/replay/wave_preview.h"
#include "services/replay/waved_log.h"
#include "services/rgbdt/print_report.h"
#include "services/rgbdt/verbs.h"
#include "services/runtime/process.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLive = "live";
constexpr double kUsualListen = 25;  // [s]

struct SyncFlags {
  std::string log, calibration, out = "out/sync";
  BusFlags bus;
  double seconds = kUsualListen;  ///< how long `live` listens
  bool refine = false, find_poses = false;
};

void PrintCamera(const SyncedCamera& camera, const CameraSpec& spec) {
  const char* name = camera.camera.c_str();
  if (!camera.why_not.empty()) {
    std::printf("%s: no offset: %s\n", name, camera.why_not.c_str());
  } else {
    const Estimate& offset = camera.time_offset_s;
    std::printf(
        "%s: time offset %+.3f +- %.3f ms (LIDAR's time = utime + offset), read-out %.3f +- "
        "%.3f ms; %d images, corners to %.3f px\n",
        name, 1e3 * offset.value, 1e3 * offset.sigma, 1e3 * camera.rolling_s.value,
        1e3 * camera.rolling_s.sigma, camera.images, camera.corner_rms_px);
    std::printf("  %s\n", OffsetInPixels(spec, offset.value).c_str());
  }
  for (const std::string& warning : camera.warnings) {
    std::printf("  warning: %s\n", warning.c_str());
  }
}

// What came out, in the calibration that it began from.
Calibration WithTimings(const WavedLog& input, const SyncResult& result, bool refine) {
  Calibration calibration;
  calibration.rig_hash = input.rig.hash;
  calibration.method = "sync";
  if (input.calibration) calibration = *input.calibration;
  if (!calibration.sensors) calibration.sensors = SensorsOf(input.rig);
  for (std::size_t i = 0; i < result.cameras.size(); ++i) {
    const SyncedCamera& synced = result.cameras[i];
    if (!synced.why_not.empty()) continue;
    const WavedCamera& began = input.board.cameras[i];
    for (const WavedImage& image : began.images) {
      calibration.utime = std::max(calibration.utime, image.utime);
    }
    CameraCalibration* own = nullptr;
    for (CameraCalibration& camera : calibration.cameras) {
      if (camera.camera == synced.camera) own = &camera;
    }
    if (own == nullptr) {
      calibration.cameras.emplace_back().camera = synced.camera;
      own = &calibration.cameras.back();
    }
    if (refine || !began.camera_from_lidar) {
      own->camera_from_lidar = synced.camera_from_lidar;
      own->covariance = synced.covariance;
      own->status = SolveStatus::kConverged;
      own->detail = "by a waved board";
      // What went with the pose that it was; the new one was found with the lens taken as it is.
      if (!began.camera_from_lidar) own->lens.reset();
      if (own->lens) own->lens->covariance.leftCols<6>().setZero();
      own->range_errors = input.range_errors;
      if (result.range_offset_m) {  // what is left of them
        if (!own->range_errors) own->range_errors.emplace();
        own->range_errors->offset_m.value -= result.range_offset_m->value;
        own->range_errors->offset_m.sigma = result.range_offset_m->sigma;
      }
    }
    own->timing = CameraTiming{synced.time_offset_s, synced.rolling_s};
  }
  return calibration;
}

// Each camera's offset over time, as the picture has it.
std::string OffsetsCsv(const SyncResult& result) {
  std::string text = "camera,utime_us,time_offset_s,sigma_s\n";
  for (const SyncedCamera& camera : result.cameras) {
    for (const OffsetAt& at : camera.offsets) {
      const auto utime = static_cast<long long>(result.start + FromSeconds(at.seconds));
      text +=
          camera.camera + Format(",%lld,%.7f,%.7f\n", utime, at.offset_s.value, at.offset_s.sigma);
    }
  }
  return text;
}

using Say = std::function<void(const std::string& progress)>;

/// What came of a log.
struct Synced {
  bool all = false;      ///< every camera tells its offset
  bool written = false;  ///< a calibration
  std::string words;     ///< what was written, and what to do next
  std::vector<WavedClock> clocks;
};

// Writes calibration, rig and picture.
Synced Write(const fs::path& out, const WavedLog& input, const SyncResult& result, bool refine) {
  Synced synced;
  synced.clocks = ClocksOf(result);
  const auto told = [](const WavedClock& clock) { return clock.time_offset_s.has_value(); };
  synced.all = std::all_of(synced.clocks.begin(), synced.clocks.end(), told);
  synced.written = std::any_of(synced.clocks.begin(), synced.clocks.end(), told);
  const cv::Mat picture = SyncPicture(result);
  if (!picture.empty()) {
    WritePng(out / "sync.png", picture);
    WriteFileAtomically(out / "sync.csv", OffsetsCsv(result));
  }
  if (!synced.written) {
    // Offsets that change too much to be given make a picture.
    synced.words = picture.empty()
                       ? "nothing was written"
                       : "only sync.png and sync.csv (the offsets over time) were written, into " +
                             out.string();
    return synced;
  }
  WriteFileAtomically(out / "rig.textproto", input.rig.text);
  WriteCalibration(out / "calibration.textproto", WithTimings(input, result, refine));
  synced.words =
      "wrote calibration.textproto (with `timing`), rig.textproto" +
      std::string(picture.empty() ? "" : ", sync.png and sync.csv (the offsets over time)") +
      " into " + out.string() + "\nnext: rgbdt-monitor " + ForShell(out.string()) +
      ", which sends both; the fuser takes offset and read-out from there";
  return synced;
}

Synced SyncLog(const SyncFlags& flags, const std::string& log,
               const std::optional<Calibration>& calibration, const WavedLogOptions& options,
               const Say& say) {
  CheckWritable(fs::path(flags.out) / "calibration.textproto");
  int percent = 0;
  const WavedLog input = ReadWavedLog(log, calibration, options, [&](double share) {
    const int now = static_cast<int>(100 * share);
    if (now / 10 != percent / 10) say("reading the log: " + std::to_string(now) + "%");
    percent = now;
  });
  PrintUnreadable(input.problems, "not used");
  say("solving ...");
  const SyncResult result = Synchronise(input.board);
  for (std::size_t i = 0; i < result.cameras.size(); ++i) {
    PrintCamera(result.cameras[i], input.board.cameras[i].spec);
  }
  Synced synced = Write(flags.out, input, result, flags.refine);
  if (synced.written) {
    std::printf(
        "%d sweeps in %.1f s; the board moved by %.2f m/s and %.2f rad/s (RMS), its points "
        "are %.1f mm off it\n",
        result.sweeps, result.seconds, result.speed, result.turn_speed, 1e3 * result.plane_rms_m);
  }
  std::printf("%s\n", synced.words.c_str());
  return synced;
}

// What the bus says while the board is waved, as a log; Ctrl-C ends it sooner.
WaveProgress Record(const std::string& log, const SyncFlags& flags, WavePreview* preview) {
  RecordingNode node(
      log, flags.seconds, [](const std::string& line) { PrintProgress(line); }, preview);
  const int code = RunOnLcm(
      node, flags.bus, [&](const std::string& channel, const std::uint8_t* data, std::size_t size) {
        node.Overhear(channel, data, size, HostUtime());
      });
  if (code != 0) throw InputError("nothing was recorded");
  try {
    node.Close();
  } catch (const InputError& error) {
    TellingNode failed(node.Told());
    failed.End(WavePhase::kFailed, error.what(), {});
    RunOnLcm(failed, flags.bus);
    throw;
  }
  return node.Told();
}

// Solves on a thread of its own, while the bus hears how far it is.
Synced SolveAndTell(const WaveProgress& recorded, const BusFlags& bus,
                    const std::function<Synced(const Say& say)>& solve) {
  TellingNode node(recorded);
  std::future<Synced> solved = std::async(std::launch::async, [&] {
    try {
      Synced synced = solve([&](const std::string& progress) {
        PrintProgress(progress);
        node.Tell(progress);
      });
      node.End(synced.written ? WavePhase::kDone : WavePhase::kFailed, synced.words, synced.clocks);
      return synced;
    } catch (const std::exception& error) {
      node.End(WavePhase::kFailed, error.what(), {});
      throw;
    }
  });
  RunOnLcm(node, bus);
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  if (!node.finished()) PrintProgress("still solving; Ctrl-C once more ends it");
  return solved.get();
}

Synced SyncLive(const SyncFlags& flags, const std::optional<Calibration>& calibration,
                const WavedLogOptions& options) {
  const fs::path log = fs::path(flags.out) / "wave.lcmlog";
  CheckWritable(log);
  fs::create_directories(flags.out);
  auto preview = std::make_unique<WavePreview>(calibration, options);
  const WaveProgress recorded = Record(log.string(), flags, preview.get());
  return SolveAndTell(recorded, flags.bus, [&](const Say& say) {
    preview.reset();  // what it is at may take seconds: the bus hears on meanwhile
    return SyncLog(flags, log.string(), calibration, options, say);
  });
}

int RunSync(const SyncFlags& flags) {
  if (flags.seconds != kUsualListen && flags.log != kLive) {
    throw UsageError("--seconds is how long `live` listens; a log is read whole");
  }
  std::optional<Calibration> calibration;
  if (!flags.calibration.empty()) calibration = ReadCalibration(flags.calibration);
  WavedLogOptions options;
  options.find_poses = flags.find_poses;
  const Synced synced = flags.log == kLive
                            ? SyncLive(flags, calibration, options)
                            : SyncLog(flags, flags.log, calibration, options, PrintProgress);
  return EndsWith(synced.all);
}

}  // namespace

void AddSync(CommandLine* program) {
  auto flags = std::make_shared<SyncFlags>();
  CommandLine* verb = program->Verb(
      "sync",
      "When does each camera see what its images say? From a log (RIG, CLOUD of a spinning LIDAR\n"
      "with the points' times, images) in which a person waves the board for some twenty seconds\n"
      "before the sensors, towards them and away, tilting it: each camera's time offset against\n"
      "the LIDAR (within 1 s, no guess), the read-out time of its shutter, and its pose, with "
      "sigma.\n"
      "Clocks that drift or jump, and frames that are repeated, are named.\n"
      "`live` in place of a log listens to the bus: wave for as long as it says. Every few\n"
      "seconds it tells how well each offset is known so far, as does the page (Session).\n"
      "Example: rgbdt sync wave.lcmlog --calibration out/session/calibration.textproto",
      [flags] { return RunSync(*flags); });
  verb->Ends(ExitCode::kFailed, "failed, or a camera does not tell its offset");
  verb->Required("LOG", &flags->log, "log written by lcm-logger, or `live`");
  verb->Within("--seconds", &flags->seconds, 2, 600, "how long `live` listens [s]");
  verb->Option("--calibration", &flags->calibration,
               "where the cameras sit; without it the log's CALIBRATION says, or the sweeps do");
  verb->Flag("--refine", &flags->refine,
             "write the pose that came out, too; else a pose that was known stays");
  verb->Flag("--find-poses", &flags->find_poses,
             "find the poses from the waved board alone, whatever a calibration says");
  verb->Option("--out", &flags->out,
               "the folder to write calibration, rig and picture into, and what `live` heard "
               "(wave.lcmlog)");
  verb->Bus(&flags->bus.url, &flags->bus.key);
}

}  // namespace rgbdt
