#include "tests/study/scanner_scenes.h"

#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "calib/scan_assembly/encoder_track.h"
#include "calib/scan_assembly/line_to_cloud.h"
#include "calib/scan_assembly/sweep_chunks.h"
#include "calib/simulate/internal/scanner.h"
#include "calib/simulate/internal/scene.h"
#include "calib/simulate/internal/world.h"

namespace rgbdt::study {
namespace {

using simulate::kDegree;

constexpr Utime kStart = 1'700'000'000'000'000;
constexpr Utime kEncoderPeriod = 10'000;

/// Seeded numbers; the same on every machine.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : engine_(static_cast<std::uint32_t>(seed * 7919 + 1)) {}

  double Within(double most) { return most * (2 * (engine_() / 4294967296.0) - 1); }
  Eigen::Vector3d Vector(double most) {
    const double x = Within(most), y = Within(most);
    return {x, y, Within(most)};
  }
  Eigen::Vector3d Signs(double size) {
    const Eigen::Vector3d drawn = Vector(1);
    return drawn.unaryExpr([&](double v) { return v < 0 ? -size : size; });
  }

 private:
  std::mt19937 engine_;
};

Cloud Assemble(const TurnedScanner& geometry, const simulate::Scanner& scanner,
               const simulate::World& world) {
  EncoderTrack track;
  const Utime length = scanner.sweep_lines() * scanner.line_period();
  for (Utime t = 0; t <= length + kEncoderPeriod; t += kEncoderPeriod) {
    track.Add({kStart + t, 0, scanner.Ticks(scanner.MotorAngle(ToSeconds(t))), kStart});
  }
  std::vector<CloudChunk> chunks;
  for (int i = 0; i < scanner.sweep_lines(); ++i) {
    const LineScan line = scanner.Line(world, kStart, i);
    const auto angles = BeamAngles(geometry, track, line, kMicrosecondsPerSecond);
    CloudChunk chunk;
    chunk.cloud = LineToCloud(geometry, line, angles.value());
    chunk.cloud.first_line = i;
    chunks.push_back(std::move(chunk));
  }
  return JoinChunks(chunks);
}

}  // namespace

ScannerCase MakeScannerCase(std::uint64_t seed, const ScannerError& error,
                            const simulate::ScannerOptions& scanner) {
  Draw draw(seed);
  simulate::Options options;
  options.seed = seed;
  options.scene = simulate::Scene::kIndoor;
  options.scanner = scanner;
  options.scanner.lever_arm_m = Eigen::Vector3d(0, 0, 0.05) + draw.Vector(0.04);
  options.scanner.tilt_rad = draw.Vector(1 * kDegree);
  options.world.ground_z_m = -1.2 + draw.Within(0.3);
  options.Check();
  const simulate::World world(std::make_shared<simulate::SceneModel>(MakeScene(options)),
                              std::nullopt, options);
  const simulate::Scanner simulated(options.scanner, seed);
  ScannerCase made;
  made.truth = made.guess = simulated.geometry();
  const Eigen::Vector3d turn = draw.Signs(error.tilt_rad);
  Rigid3& guess = made.guess.motor_from_scanner;
  if (turn.norm() > 0) {
    guess.rotation = RotationAbout(turn.normalized(), turn.norm()).rotation * guess.rotation;
  }
  guess.translation += draw.Signs(error.lever_m);
  made.beams = BeamsOfCloud(made.guess, Assemble(made.guess, simulated, world));
  return made;
}

Eigen::Vector4d ScannerErrorOf(const Rigid3& truth, const Rigid3& estimate) {
  Rigid3 aligned = truth;
  Vector6d delta;
  for (int i = 0; i < 5; ++i) {  // turns do not quite add up
    delta = Log(aligned * estimate.Inverse());
    Vector6d along = Vector6d::Zero();
    along[2] = -delta[2];
    along[5] = -delta[5];
    aligned = Exp(along) * aligned;
  }
  delta = Log(aligned * estimate.Inverse());
  return {delta[0], delta[1], delta[3], delta[4]};
}

Eigen::Matrix4d ObservableCovariance(const ScannerGeometry& geometry) {
  const int places[] = {0, 1, 3, 4};
  Eigen::Matrix4d covariance;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) covariance(i, j) = geometry.covariance(places[i], places[j]);
  }
  return covariance;
}

}  // namespace rgbdt::study
