#include "calib/simulate/internal/livox.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "calib/model/parallel.h"
#include "calib/simulate/internal/beam.h"
#include "calib/simulate/internal/noise.h"

namespace rgbdt::simulate {
namespace {

constexpr double kTwoPi = 2 * M_PI;

// Avia.
constexpr double kWedge1_hz = 7294.0 / 60, kWedge2_hz = -4664.0 / 60;
constexpr double kCircle = 70.4 * kDegree, kHigh = 77.2 * kDegree;
constexpr int kAviaLasers = 6;

// Mid-360.
constexpr double kLow = -7 * kDegree, kTop = 52 * kDegree;
constexpr int kMid360Lasers = 4;
// Of 4 lasers, so 40 lines in 0.1 s. A turn is 500.618 firings: the next turn's lie between this
// one's, as evenly as the golden ratio spreads them.
constexpr double kTurnHz = 50'000 / 500.6180339887498949;
constexpr double kNodHz = 6.180339887498949;  // to the turns as no two whole numbers are
constexpr double kLaserStep = (kTop - kLow) / 40;

double AviaLaserHeight(int laser) {
  return (kHigh - kCircle) * (static_cast<double>(laser) / (kAviaLasers - 1) - 0.5);
}

Eigen::Vector3d AviaDirection(double time_s, int laser) {
  const double one = kTwoPi * std::fmod(kWedge1_hz * time_s, 1.0);
  const double two = kTwoPi * std::fmod(kWedge2_hz * time_s, 1.0);
  const double across = kCircle / 4 * (std::cos(one) + std::cos(two));
  const double up = kCircle / 4 * (std::sin(one) + std::sin(two)) + AviaLaserHeight(laser);
  // An angle from the axis, and about it.
  const double off = std::hypot(across, up);
  if (off == 0) return Eigen::Vector3d::UnitX();
  return {std::cos(off), std::sin(off) * across / off, std::sin(off) * up / off};
}

Eigen::Vector3d Mid360Direction(double time_s, int laser) {
  const double azimuth = kTwoPi * std::fmod(kTurnHz * time_s, 1.0);
  const double nod = std::sin(kTwoPi * std::fmod(kNodHz * time_s, 1.0));
  const double reach = (kTop - kLow - (kMid360Lasers - 1) * kLaserStep) / 2;
  const double elevation = kLow + reach * (1 + nod) + kLaserStep * laser;
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
          std::sin(elevation)};
}

// The beam's oval, about a beam along x: divergence_rad high, divergence_across_rad wide.
std::vector<Eigen::Vector3d> Oval(const LivoxOptions& options) {
  std::vector<Eigen::Vector3d> rays = SubRays(options, 0);
  const double across = options.divergence_across_rad / options.divergence_rad;
  for (Eigen::Vector3d& ray : rays) {
    ray = Eigen::Vector3d(ray.x(), across * ray.y(), ray.z()).normalized();
  }
  return rays;
}

// Left and up of a direction.
struct Axes {
  Eigen::Vector3d left, up;
  explicit Axes(const Eigen::Vector3d& along)
      : left(Eigen::Vector3d::UnitZ().cross(along).normalized()), up(along.cross(left)) {}
};

// What beams `first` to `last` - 1 return.
class Caster {
 public:
  Caster(const World& world, const LivoxOptions& options, Utime utime)
      : world_(world), options_(options), oval_(Oval(options)) {
    begin_s_ = ToSeconds(utime % (3600 * kMicrosecondsPerSecond));
  }

  double TimeOf(std::int64_t beam) const {
    const int lasers = LivoxLasers(options_.model);
    return static_cast<double>(beam / lasers) * lasers / options_.points_per_s;
  }
  Eigen::Vector3d DirectionOf(std::int64_t beam) const {
    const auto laser = static_cast<int>(beam % LivoxLasers(options_.model));
    return LivoxDirection(options_.model, begin_s_ + TimeOf(beam), laser);
  }
  void Cast(std::int64_t first, std::int64_t last, BeamReturn* returns) const {
    std::vector<Eigen::Vector3d> directions;
    for (std::int64_t beam = first; beam < last; ++beam) {
      const Eigen::Vector3d along = DirectionOf(beam);
      const Axes axes(along);
      for (const Eigen::Vector3d& ray : oval_) {
        directions.push_back(ray.x() * along + ray.y() * axes.left + ray.z() * axes.up);
      }
    }
    CastBeams(world_, options_, Eigen::Vector3d::Zero(), directions, static_cast<int>(oval_.size()),
              returns);
  }

 private:
  const World& world_;
  const LivoxOptions& options_;
  std::vector<Eigen::Vector3d> oval_;
  double begin_s_ = 0;
};

}  // namespace

int LivoxLasers(LivoxModel model) {
  return model == LivoxModel::kAvia ? kAviaLasers : kMid360Lasers;
}

Eigen::Vector3d LivoxDirection(LivoxModel model, double time_s, int laser) {
  return model == LivoxModel::kAvia ? AviaDirection(time_s, laser) : Mid360Direction(time_s, laser);
}

bool InLivoxField(LivoxModel model, const Eigen::Vector3d& point, double margin_rad) {
  if (model == LivoxModel::kMid360) {
    const double elevation = std::atan2(point.z(), point.head<2>().norm());
    return elevation > kLow + margin_rad && elevation < kTop - margin_rad;
  }
  // The circle that all lasers see.
  const double off = std::atan2(point.tail<2>().norm(), point.x());
  const double up = off * std::abs(point.z()) / std::max(1e-9, point.tail<2>().norm());
  const double across = std::sqrt(std::max(0.0, off * off - up * up));
  return std::hypot(across, up + (kHigh - kCircle) / 2) < kCircle / 2 - margin_rad;
}

Cloud LivoxCloud(const World& world, const LivoxOptions& options, std::uint64_t seed, Utime utime,
                 int threads) {
  options.Check();
  const auto count = static_cast<std::int64_t>(options.seconds * options.points_per_s);
  constexpr std::int64_t kBlock = 32;
  const Caster caster(world, options, utime);
  std::vector<BeamReturn> returns(static_cast<std::size_t>(count));
  const auto blocks = static_cast<int>((count + kBlock - 1) / kBlock);
  ForEach(blocks, threads, [&](int block) {
    const std::int64_t first = block * kBlock;
    caster.Cast(first, std::min(count, first + kBlock), &returns[static_cast<std::size_t>(first)]);
  });
  const Noise noise(seed, utime, "livox");
  Cloud cloud;
  cloud.sweep_utime = utime;
  for (std::int64_t beam = 0; beam < count; ++beam) {
    const BeamReturn& back = returns[static_cast<std::size_t>(beam)];
    if (std::isnan(back.range)) continue;
    const auto draw = static_cast<std::uint64_t>(4 * beam);
    const double range =
        back.range + RangeError(options, back) + RangeSigma(options, back) * noise.Normal(draw);
    const Eigen::Vector3d along = caster.DirectionOf(beam);
    const Axes axes(along);
    const Eigen::Vector3d told =
        along + options.angle_sigma_rad *
                    (noise.Normal(draw + 1) * axes.left + noise.Normal(draw + 2) * axes.up);
    cloud.points.push_back((range * told.normalized()).cast<float>());
    cloud.intensity.push_back(NoisyIntensity(options, back, noise.Normal(draw + 3)));
    cloud.utime.push_back(utime + FromSeconds(caster.TimeOf(beam)));
  }
  cloud.lines = 1;
  cloud.beams = static_cast<int>(cloud.size());
  cloud.organised = false;
  return cloud;
}

}  // namespace rgbdt::simulate
