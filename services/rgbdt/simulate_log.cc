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

/// What a log of the rig has in common: RIG once a second, sweeps one behind the other, images.
class RigLog {
 public:
  RigLog(const std::filesystem::path& path, const Rig& rig,
         const std::optional<Calibration>& calibration, double seconds)
      : log_(path.string()), rig_(rig), calibration_(calibration), seconds_(seconds) {}

  void AddSweep(const Cloud& sweep, Utime end) {
    for (CloudChunk& chunk : SplitSweep(sweep)) log_.Add(std::move(chunk), end + kUnderWay);
  }
  void AddImage(Image image, Utime utime) { log_.Add(Packed(std::move(image)), utime + kUnderWay); }
  // Nothing that comes later was heard before. Once a second: RIG, and how far it is.
  void Reached(Utime utime, Utime start) {
    log_.WriteUntil(utime);
    const auto second = static_cast<int>(ToSeconds(utime - start));
    if (second == told_) return;
    told_ = second;
    log_.AddRig(rig_, calibration_, utime);
    std::fprintf(stderr, "[%d/%.0f] seconds simulated\n", second, seconds_);
  }
  void Close() { log_.Close(); }

 private:
  TimedLog log_;
  Rig rig_;
  std::optional<Calibration> calibration_;
  double seconds_;
  int told_ = -1;
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

std::vector<Shutter> ShuttersOf(const Rig& rig, double color_hz, double thermal_hz, Utime start) {
  std::vector<Shutter> shutters;
  for (const CameraSpec& camera : rig.cameras) {
    shutters.emplace_back(camera.name, camera.kind == CameraKind::kColor ? color_hz : thermal_hz,
                          start);
  }
  return shutters;
}

Calibration TrueCalibration(const Rig& rig, const Truth& truth) {
  Calibration calibration;
  calibration.method = "truth";
  calibration.rig_hash = rig.hash;
  calibration.sensors = SensorsOf(rig);
  for (const auto& [name, pose] : truth.camera_from_lidar) {
    CameraCalibration& camera = calibration.cameras.emplace_back();
    camera.camera = name;
    camera.camera_from_lidar = pose;
    camera.status = SolveStatus::kConverged;
    camera.covariance = Matrix6d(1e-10 * Matrix6d::Identity());
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
  constexpr double kColor_hz = 20, kThermal_hz = 9;
  const simulate::WaveOptions wave;
  const auto clocks = simulate::DrawClocks(options);
  simulate::Waving waving(options, wave, clocks);
  const Rig rig = WrittenRig(dir, waving.rig());
  WriteTruth(dir / "truth.textproto", waving.truth(),
             simulate::ClocksText(options, clocks) + simulate::ImperfectionsText(options));
  RigLog log(dir / "wave.lcmlog", rig, std::nullopt, seconds);
  auto shutters = ShuttersOf(rig, kColor_hz, kThermal_hz, wave.start);
  const Utime revolution = FromSeconds(options.spinning->revolution_s);
  const Utime end = wave.start + FromSeconds(seconds);
  for (Utime utime = wave.start; utime < end; utime += revolution) {
    log.Reached(utime, wave.start);
    log.AddSweep(waving.Sweep(utime), utime + revolution);
    for (Shutter& shutter : shutters) {
      for (; shutter.Next() < utime + revolution; shutter.Taken()) {
        log.AddImage(waving.TakeImage(shutter.camera(), shutter.Next()), shutter.Next());
      }
    }
  }
  log.Close();
  std::printf(
      "wrote %s: rig.textproto, wave.lcmlog (%.0f s), truth.textproto (with what each clock is off "
      "by)\nnext: rgbdt sync %s\n",
      dir.c_str(), seconds, ForShell((dir / "wave.lcmlog").string()).c_str());
}

void SimulateDrive(const std::filesystem::path& dir, const simulate::Options& options,
                   double seconds) {
  constexpr double kImage_hz = 2, kStreet_mps = 3, kRoom_mps = 0.5;
  using simulate::Driving;
  Driving driving(options, options.scene == simulate::Scene::kIndoor ? kRoom_mps : kStreet_mps);
  const Rig rig = WrittenRig(dir, driving.rig());
  WriteTruth(dir / "truth.textproto", driving.truth());
  const Calibration calibration = TrueCalibration(rig, driving.truth());
  WriteCalibration(dir / "calibration.textproto", calibration);
  RigLog log(dir / "drive.lcmlog", rig, calibration, seconds);
  auto shutters = ShuttersOf(rig, kImage_hz, kImage_hz, Driving::kStart);
  const Utime revolution = FromSeconds(options.spinning->revolution_s);
  const Utime end = Driving::kStart + FromSeconds(seconds);
  std::vector<StampedPose> way;
  for (Utime utime = Driving::kStart; utime < end; utime += revolution) {
    log.Reached(utime, Driving::kStart);
    log.AddSweep(driving.Sweep(utime), utime + revolution);
    way.push_back({0, utime + revolution, "truth", driving.WorldFromLidar(utime + revolution)});
    for (Shutter& shutter : shutters) {
      for (; shutter.Next() < utime + revolution; shutter.Taken()) {
        log.AddImage(driving.TakeImage(shutter.camera(), shutter.Next()), shutter.Next());
      }
    }
  }
  log.Close();
  WriteFileAtomically(dir / "truth.tum", TumText(way));
  std::printf(
      "wrote %s: rig.textproto, drive.lcmlog (%.0f s), calibration.textproto (the truth), "
      "truth.tum (where it was)\nnext: rgbdt map %s\n",
      dir.c_str(), seconds, ForShell((dir / "drive.lcmlog").string()).c_str());
}

}  // namespace rgbdt
