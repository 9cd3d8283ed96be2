#include "services/rgbdt/simulate_log.h"

#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/camera/packed.h"
#include "calib/files/atomic_file.h"
#include "calib/files/schema/calibration_file.h"
#include "calib/files/schema/rig_file.h"
#include "calib/files/session/session_dir.h"
#include "calib/model/text.h"
#include "calib/scan_assembly/sweep_chunks.h"
#include "calib/simulate/driving.h"
#include "calib/simulate/imperfections.h"
#include "calib/simulate/waving.h"
#include "services/import/timed_log.h"
#include "services/replay/drive_map.h"

namespace rgbdt {
namespace {

constexpr Utime kUnderWay = 20'000;  // from a sensor's last row or point until it is heard

struct LogOptions {
  std::filesystem::path log;
  Utime start = 0;
  double seconds = 0, revolution_s = 0;
  double color_hz = 0, thermal_hz = 0;  // of images
  std::optional<Calibration> calibration{};
};

// When images of a camera are taken: its n-th.
class Shutter {
 public:
  Shutter(std::string camera, double hz, Utime start)
      : camera_(std::move(camera)), hz_(hz), start_(start) {}
  const std::string& camera() const { return camera_; }
  Utime Next() const { return start_ + FromSeconds((taken_ + 0.37) / hz_); }
  void Taken() { ++taken_; }

 private:
  std::string camera_;
  double hz_;
  Utime start_;
  int taken_ = 0;
};

std::vector<Shutter> ShuttersOf(const Rig& rig, const LogOptions& what) {
  std::vector<Shutter> shutters;
  for (const CameraSpec& camera : rig.cameras) {
    const bool color = camera.kind == CameraKind::kColor;
    shutters.emplace_back(camera.name, color ? what.color_hz : what.thermal_hz, what.start);
  }
  return shutters;
}

// One sweep behind the other, images as on a bus that leaves the machine; once a second RIG, and
// how far it is. `source`: Waving, or Driving.
template <typename Source>
void Record(const LogOptions& what, const Rig& rig, Source* source) {
  TimedLog log(what.log);
  std::vector<Shutter> shutters = ShuttersOf(rig, what);
  const Utime revolution = FromSeconds(what.revolution_s);
  const Utime end = what.start + FromSeconds(what.seconds);
  int told = -1;
  for (Utime utime = what.start; utime < end; utime += revolution) {
    log.WriteUntil(utime);  // nothing that comes later was heard before
    const auto second = static_cast<int>(ToSeconds(utime - what.start));
    if (std::exchange(told, second) != second) {
      log.AddRig(rig, what.calibration, utime);
      std::fprintf(stderr, "[%d/%.0f] seconds simulated\n", second, what.seconds);
    }
    for (CloudChunk& chunk : SplitSweep(source->Sweep(utime))) {
      log.Add(std::move(chunk), utime + revolution + kUnderWay);
    }
    for (Shutter& shutter : shutters) {
      for (; shutter.Next() < utime + revolution; shutter.Taken()) {
        log.Add(Packed(source->TakeImage(shutter.camera(), shutter.Next())),
                shutter.Next() + kUnderWay);
      }
    }
  }
  log.Close();
}

// Where it is at the end of each sweep.
std::vector<StampedPose> TrueWay(const simulate::Driving& driving, const LogOptions& what) {
  const Utime revolution = FromSeconds(what.revolution_s);
  const Utime end = what.start + FromSeconds(what.seconds);
  std::vector<StampedPose> way;
  for (Utime utime = what.start; utime < end; utime += revolution) {
    way.push_back({0, utime + revolution, "truth", driving.WorldFromLidar(utime + revolution)});
  }
  return way;
}

// Nobody calibrated it: what is known exactly has some sigma all the same.
Calibration TrueCalibration(const Rig& rig, const Truth& truth, const simulate::Options& options,
                            const std::vector<simulate::ClockOptions>& clocks, double seconds) {
  constexpr double kVariance = 1e-10;
  Calibration calibration;
  calibration.method = "truth";
  calibration.rig_hash = rig.hash;
  calibration.sensors = SensorsOf(rig);
  for (std::size_t i = 0; i < options.cameras.size(); ++i) {
    const simulate::CameraOptions& from = options.cameras[i];
    CameraCalibration& camera = calibration.cameras.emplace_back();
    if (!clocks.empty()) {  // of a clock that drifts the mean, as sync has it
      const double half_drift = 0.5 * seconds * clocks[i].drift;
      camera.timing = CameraTiming{{clocks[i].offset_s + half_drift, std::abs(half_drift) + 1e-6},
                                   {clocks[i].rolling_s, 1e-6}};
    }
    camera.camera = from.name;
    camera.camera_from_lidar = truth.camera_from_lidar.at(from.name);
    camera.status = SolveStatus::kConverged;
    camera.covariance = Matrix6d(kVariance * Matrix6d::Identity());
    if (from.lens_error.isZero(0)) continue;
    SolvedLens& lens = camera.lens.emplace();
    lens.lens = from.lens;
    lens.covariance.setZero();
    lens.covariance.rightCols<kLensNumbers>().diagonal().setConstant(kVariance);
  }
  return calibration;
}

Rig WrittenRig(const std::filesystem::path& dir, const Rig& rig) {
  Rig written = ParseRig(PrintRig(rig), "synthetic rig");
  WriteRig(dir, written);
  return written;
}

}  // namespace

void SimulateWave(const std::filesystem::path& dir, const simulate::Options& options,
                  double seconds) {
  constexpr double kColorHz = 20, kThermalHz = 9;
  const simulate::WaveOptions wave;
  const auto clocks = simulate::DrawClocks(options);
  simulate::Waving waving(options, wave, clocks);
  const Rig rig = WrittenRig(dir, waving.rig());
  WriteTruth(dir / "truth.textproto", waving.truth(),
             simulate::ClocksText(options, clocks) + simulate::ImperfectionsText(options));
  Record({dir / "wave.lcmlog", wave.start, seconds, options.spinning->revolution_s, kColorHz,
          kThermalHz},
         rig, &waving);
  std::printf(
      "wrote %s: rig.textproto, wave.lcmlog (%.0f s), truth.textproto (with what each clock is off "
      "by)\nnext: rgbdt sync %s\n",
      dir.c_str(), seconds, ForShell((dir / "wave.lcmlog").string()).c_str());
}

void SimulateDrive(const std::filesystem::path& dir, const simulate::Options& options,
                   double seconds, Clocks of_cameras) {
  constexpr double kImageHz = 2, kStreet_mps = 3, kRoom_mps = 0.5;
  using simulate::Driving;
  const auto clocks = of_cameras == Clocks::kOff ? simulate::DrawClocks(options)
                                                 : std::vector<simulate::ClockOptions>();
  Driving driving(options, options.scene == simulate::Scene::kIndoor ? kRoom_mps : kStreet_mps,
                  clocks);
  const Rig rig = WrittenRig(dir, driving.rig());
  WriteTruth(dir / "truth.textproto", driving.truth(),
             (clocks.empty() ? "" : simulate::ClocksText(options, clocks)) +
                 simulate::ImperfectionsText(options));
  const Calibration calibration = TrueCalibration(rig, driving.truth(), options, clocks, seconds);
  WriteCalibration(dir / "calibration.textproto", calibration);
  const LogOptions what{dir / "drive.lcmlog",
                        Driving::kStart,
                        seconds,
                        options.spinning->revolution_s,
                        kImageHz,
                        kImageHz,
                        calibration};
  Record(what, rig, &driving);
  WriteFileAtomically(dir / "truth.tum", TumText(TrueWay(driving, what)));
  std::printf(
      "wrote %s: rig.textproto, drive.lcmlog (%.0f s), calibration.textproto (the truth), "
      "truth.tum (where it was)\nnext: rgbdt map %s\n",
      dir.c_str(), seconds, ForShell((dir / "drive.lcmlog").string()).c_str());
}

}  // namespace rgbdt
