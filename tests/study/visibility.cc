#include "tests/study/visibility.h"

#include <algorithm>
#include <cmath>

#include "calib/fuse/sweep_fuser.h"
#include "calib/simulate/internal/cloud_world.h"
#include "calib/simulate/simulator.h"

namespace rgbdt::study {
namespace {

using simulate::CloudWorld;
using simulate::Hit;
using simulate::RayCaster;

// One beam, as rays tell of it.
struct Beam {
  Eigen::Vector3d origin, direction;

  Beam(const Cloud& cloud, std::size_t i) : origin(0, 0, 0) {
    direction = cloud.directions[i].cast<double>().normalized();
    const auto line = i / static_cast<std::size_t>(cloud.beams);
    if (!cloud.origins.empty()) origin = cloud.origins[line].cast<double>();
  }
};

// Whether rays round a beam's middle meet another thing, or not the same plane.
bool MeetsTwo(const RayCaster& caster, const Beam& beam, const Hit& middle, double width_rad) {
  constexpr int kRays = 8;
  constexpr double kOffM = 0.03;
  const Eigen::Vector3d a = beam.direction.unitOrthogonal();
  const Eigen::Vector3d b = beam.direction.cross(a);
  const double to_plane = middle.range * middle.normal.dot(beam.direction);
  for (int k = 0; k < kRays; ++k) {
    const double angle = 2 * M_PI * k / kRays;
    const Eigen::Vector3d ray =
        (beam.direction + 0.5 * width_rad * (std::cos(angle) * a + std::sin(angle) * b))
            .normalized();
    const Hit hit = caster.Cast(beam.origin, ray);
    if (!hit.hit() || hit.object != middle.object) return true;
    if (std::abs(to_plane / middle.normal.dot(ray) - hit.range) > kOffM) return true;
  }
  return false;
}

enum class Truth { kUnknown, kHidden, kVisible };

Truth TruthOf(const RayCaster& caster, const Beam& beam, const Eigen::Vector3d& camera,
              double width_rad) {
  constexpr double kOffSurface = 1e-3;
  const Hit hit = caster.Cast(beam.origin, beam.direction);
  if (!hit.hit() || MeetsTwo(caster, beam, hit, width_rad)) return Truth::kUnknown;
  const Eigen::Vector3d place = beam.origin + hit.range * beam.direction;
  if (hit.normal.dot(camera - place) <= 0) return Truth::kHidden;
  const Eigen::Vector3d from = place + kOffSurface * hit.normal;
  const double distance = (camera - from).norm();
  return caster.Blocked(from, (camera - from) / distance, distance) ? Truth::kHidden
                                                                    : Truth::kVisible;
}

Cloud Lines(const Cloud& cloud, int first, int count) {
  const auto begin = static_cast<std::ptrdiff_t>(first) * cloud.beams;
  const auto end = static_cast<std::ptrdiff_t>(first + count) * cloud.beams;
  Cloud chunk;
  chunk.sweep_utime = cloud.sweep_utime;
  chunk.first_line = first;
  chunk.lines = count;
  chunk.beams = cloud.beams;
  chunk.points.assign(cloud.points.begin() + begin, cloud.points.begin() + end);
  chunk.utime.assign(cloud.utime.begin() + begin, cloud.utime.begin() + end);
  return chunk;
}

// Of four rings in turn each looks this many columns ahead, once round.
Cloud Staggered(const Cloud& cloud) {
  constexpr int kAhead[] = {9, 3, -3, -9};
  Cloud staggered = cloud;
  for (int line = 0; line < cloud.lines; ++line) {
    for (int ring = 0; ring < cloud.beams; ++ring) {
      const int from_line = (line + kAhead[ring % 4] + cloud.lines) % cloud.lines;
      const auto at = static_cast<std::size_t>(line * cloud.beams + ring);
      const auto from = static_cast<std::size_t>(from_line * cloud.beams + ring);
      staggered.points[at] = cloud.points[from];
      staggered.directions[at] = cloud.directions[from];
    }
  }
  return staggered;
}

// One camera of the rig, and which of a sweep's points it should see.
struct Judge {
  std::uint32_t bit;
  std::vector<Truth> truth;  // by hit; kUnknown where it lies outside of the image, too

  Judge(const CloudWorld& world, const Cloud& cloud, const Camera& camera,
        const Rigid3& camera_from_lidar, double width_rad, std::uint32_t own_bit)
      : bit(own_bit) {
    const Eigen::Vector3d centre = camera_from_lidar.Inverse().translation;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (!cloud.IsHit(i)) continue;
      const auto pixel = camera.Project(camera_from_lidar * cloud.points[i].cast<double>());
      const bool in_image = pixel && camera.Contains(*pixel);
      truth.push_back(in_image ? TruthOf(world.world().caster(), Beam(cloud, i), centre, width_rad)
                               : Truth::kUnknown);
    }
  }

  VisibilityScore Score(const std::vector<std::uint32_t>& valid) const {
    VisibilityScore score;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const bool coloured = (valid[i] & bit) != 0;
      if (truth[i] == Truth::kHidden) {
        ++score.hidden;
        score.hidden_coloured += coloured ? 1 : 0;
      } else if (truth[i] == Truth::kVisible) {
        ++score.visible;
        score.visible_coloured += coloured ? 1 : 0;
      }
    }
    return score;
  }
};

cv::Mat AnyPicture(const CameraSpec& spec) {
  return spec.kind == CameraKind::kThermal
             ? cv::Mat(spec.height, spec.width, CV_32FC1, cv::Scalar(7000))
             : cv::Mat(spec.height, spec.width, CV_8UC3, cv::Scalar(90, 80, 70));
}

// Cameras where they truly are, each with a picture that serves all times.
SweepFuser FuserOf(const simulate::Simulator& simulator) {
  const Rig& rig = simulator.rig();
  SweepFuser fuser(rig.cameras, rig.lidar.range_sigma_m);
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    const CameraSpec& spec = rig.cameras[c];
    const Rigid3& pose = simulator.truth().camera_from_lidar.at(spec.name);
    fuser.SetCalibration(c, {spec.name, pose, std::nullopt, SolveStatus::kConverged, ""}, 1);
    fuser.camera(c).AddImage({1, AnyPicture(spec), spec.radiometry});
    fuser.camera(c).ServeAllTimes();
  }
  return fuser;
}

std::vector<std::uint32_t> ValidOf(const std::vector<RgbdtCloud>& clouds) {
  std::vector<std::uint32_t> valid;
  for (const RgbdtCloud& c : clouds) valid.insert(valid.end(), c.valid.begin(), c.valid.end());
  return valid;
}

// A sweep in chunks; what they were at once, and all of it at its end.
struct Fused {
  std::vector<RgbdtCloud> chunks, whole;
};

Fused RunSweep(const Cloud& cloud, int lines, SweepFuser* fuser) {
  Fused fused;
  for (int first = 0; first < cloud.lines; first += lines) {
    fused.chunks.push_back(
        fuser->FuseChunk(Lines(cloud, first, std::min(lines, cloud.lines - first))));
  }
  fused.whole = fuser->EndSweep();
  return fused;
}

}  // namespace

void VisibilityScore::Add(const VisibilityScore& other) {
  hidden += other.hidden;
  hidden_coloured += other.hidden_coloured;
  visible += other.visible;
  visible_coloured += other.visible_coloured;
}

double VisibilityScore::HiddenColoured() const {
  return static_cast<double>(hidden_coloured) / static_cast<double>(std::max(1L, hidden));
}

double VisibilityScore::VisibleColoured() const {
  return static_cast<double>(visible_coloured) / static_cast<double>(std::max(1L, visible));
}

VisibilityScores ScoreVisibility(const simulate::Options& options, Columns columns) {
  const simulate::Simulator simulator(options);
  const CloudWorld world(options, 0);
  const auto sweep = [&](Utime utime) {
    Cloud cloud = world.Sweep(utime);
    return columns == Columns::kStaggered ? Staggered(cloud) : cloud;
  };
  const Cloud first = sweep(1'000'000);
  const Cloud second = sweep(100'000'000);
  SweepFuser fuser = FuserOf(simulator);
  // A spinning LIDAR's revolution comes as one.
  const int lines = options.spinning ? first.lines : 1;
  RunSweep(first, lines, &fuser);
  const Fused fused = RunSweep(second, lines, &fuser);
  const double width =
      options.spinning ? options.spinning->divergence_rad : options.scanner.divergence_rad;
  VisibilityScores scores;
  for (std::size_t c = 0; c < simulator.rig().cameras.size(); ++c) {
    const CameraSpec& spec = simulator.rig().cameras[c];
    const Judge judge(world, second, Camera(spec),
                      simulator.truth().camera_from_lidar.at(spec.name), width, 1U << c);
    scores.whole.Add(judge.Score(ValidOf(fused.whole)));
    scores.live.Add(judge.Score(ValidOf(fused.chunks)));
  }
  return scores;
}

}  // namespace rgbdt::study
