#include "tests/bench/turning_scanner.h"

#include <cmath>
#include <limits>

#include "calib/files/schema/rig_file.h"
#include "calib/simulate/internal/rig_defaults.h"

namespace rgbdt::bench {
namespace {

constexpr std::uint64_t kSeed = 1;

}  // namespace

BenchRig MakeBenchRig() {
  const simulate::Options options;
  BenchRig made;
  for (const simulate::CameraOptions& camera : options.cameras) {
    made.camera_from_lidar.push_back(simulate::DrawCameraFromLidar(camera, kSeed));
  }
  const simulate::Scanner scanner(options.scanner, kSeed);
  const Rig rig = simulate::MakeRig(options, scanner, {}, made.camera_from_lidar);
  made.text.text = PrintRig(rig);
  made.rig = ParseRig(made.text.text, "bench rig");
  made.text.hash = made.rig.hash;
  return made;
}

Messages BenchRig::Calibrations(Utime utime) const {
  Messages messages;
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    CalibrationMessage message;
    message.utime = utime;
    message.rig_hash = rig.hash;
    message.method = "auto";
    message.calibration.camera = rig.cameras[i].name;
    message.calibration.camera_from_lidar = camera_from_lidar[i];
    message.calibration.status = SolveStatus::kConverged;
    messages.push_back(message);
  }
  return messages;
}

LineScan TurningScanner::Line(std::int64_t number) const {
  const simulate::ScannerOptions scanner;
  LineScan line;
  line.utime = start_ + number * kLinePeriod;
  line.seq = number;
  line.beam_period_s = scanner.beam_period_s;
  line.first_angle_rad = scanner.first_angle_rad;
  line.angle_step_rad = scanner.angle_step_rad;
  line.range.resize(kBeams);
  line.intensity.resize(kBeams);
  for (int beam = 0; beam < kBeams; ++beam) {
    const auto i = static_cast<std::size_t>(beam);
    const double a = 0.02 * beam + 0.05 * static_cast<double>(number % kSweepLines);
    const bool miss = beam % 50 == 49;
    line.range[i] = miss ? std::numeric_limits<float>::quiet_NaN()
                         : static_cast<float>(6 + std::sin(a) + 0.2 * std::sin(7 * a));
    line.intensity[i] = static_cast<float>(0.5 + 0.4 * std::sin(3 * a));
  }
  return line;
}

EncoderReading TurningScanner::Reading(std::int64_t number) const {
  const simulate::ScannerOptions scanner;
  constexpr Utime kSweep = kSweepLines * kLinePeriod;
  EncoderReading reading;
  reading.utime = start_ + number * kReadingPeriod;
  reading.seq = number;
  const std::int64_t sweep = (reading.utime - start_) / kSweep;
  reading.sweep_utime = start_ + sweep * kSweep;
  const double part = ToSeconds(reading.utime - reading.sweep_utime) / ToSeconds(kSweep);
  const double turned = scanner.sweep_rad * (sweep % 2 == 0 ? part : 1 - part);
  reading.ticks =
      std::llround((scanner.sweep_start_rad + turned) * scanner.ticks_per_rad + scanner.zero_ticks);
  return reading;
}

}  // namespace rgbdt::bench
