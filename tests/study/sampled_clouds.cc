#include "tests/study/sampled_clouds.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/model/rigid3.h"
#include "calib/simulate/internal/scanner.h"

namespace rgbdt::study {
namespace {

using simulate::kDegree;
using simulate::Noise;

constexpr double kMarginM = 0.35;  // round the board: as far as the detector looks beyond it

/// A sensor's whole grid of beams, without making it.
class Grid {
 public:
  explicit Grid(const simulate::Options& options)
      : options_(options), scanner_(options.scanner, options.seed) {}

  int rows() const {
    return options_.spinning ? options_.spinning->rings() : scanner_.sweep_lines();
  }
  int columns() const {
    return options_.spinning ? options_.spinning->columns() : options_.scanner.beams;
  }

  Eigen::Vector3d Direction(int row, int column) const {
    if (options_.spinning) {
      return AtAngles(options_.spinning->elevations_rad[static_cast<std::size_t>(row)],
                      options_.spinning->first_azimuth_rad + column * ColumnStep());
    }
    const simulate::ScannerOptions& s = options_.scanner;
    const double seconds = row * ToSeconds(scanner_.line_period()) + column * s.beam_period_s;
    const Eigen::Quaterniond turned =
        RotationAbout(Eigen::Vector3d::UnitZ(), scanner_.MotorAngle(seconds)).rotation *
        scanner_.geometry().motor_from_scanner.rotation;
    return turned * AtAngles(s.first_angle_rad + column * s.angle_step_rad, 0);
  }

  /// About where in the grid a direction lies: row, column.
  Eigen::Vector2d Near(const Eigen::Vector3d& direction) const {
    const double azimuth = std::atan2(direction.y(), direction.x());
    const double elevation = std::atan2(direction.z(), direction.head<2>().norm());
    if (options_.spinning) {
      const auto& rings = options_.spinning->elevations_rad;
      return {(elevation - rings.front()) / RowStep(),
              (azimuth - options_.spinning->first_azimuth_rad) / ColumnStep()};
    }
    return {(azimuth - options_.scanner.sweep_start_rad) / RowStep(),
            (elevation - options_.scanner.first_angle_rad) / ColumnStep()};
  }

  /// Of a spinning LIDAR its row, of a scanner its beam.
  int Ring(int row, int column) const { return options_.spinning ? row : column; }

  double RowStep() const {
    if (!options_.spinning) {
      return options_.scanner.motor_speed_rad_s * ToSeconds(scanner_.line_period());
    }
    const auto& rings = options_.spinning->elevations_rad;
    return (rings.back() - rings.front()) / (rows() - 1);
  }
  double ColumnStep() const {
    return options_.spinning ? 360 * kDegree / columns() : options_.scanner.angle_step_rad;
  }

 private:
  static Eigen::Vector3d AtAngles(double elevation, double azimuth) {
    return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
            std::sin(elevation)};
  }

  const simulate::Options& options_;
  simulate::Scanner scanner_;
};

BeamWindow WindowAbout(const Grid& grid, const Target& target, const Rigid3& lidar_from_target) {
  Eigen::Array2d low(1e9, 1e9);
  Eigen::Array2d high(-1e9, -1e9);
  double nearest = 1e9;
  for (const Eigen::Vector3d& corner : target.OutlineCorners()) {
    const Eigen::Vector3d point = lidar_from_target * corner;
    const Eigen::Array2d near = grid.Near(point.normalized()).array();
    low = low.min(near);
    high = high.max(near);
    nearest = std::min(nearest, point.norm());
  }
  const Eigen::Array2d margin =
      2.5 + kMarginM / nearest / Eigen::Array2d(grid.RowStep(), grid.ColumnStep());
  const int first_row = std::max(0, static_cast<int>(low[0] - margin[0]));
  const int first_column = std::max(0, static_cast<int>(low[1] - margin[1]));
  BeamWindow window;
  window.rows = std::min(grid.rows(), static_cast<int>(high[0] + margin[0]) + 1) - first_row;
  window.columns =
      std::min(grid.columns(), static_cast<int>(high[1] + margin[1]) + 1) - first_column;
  for (int row = 0; row < window.rows; ++row) {
    for (int column = 0; column < window.columns; ++column) {
      window.directions.push_back(grid.Direction(first_row + row, first_column + column));
      window.ring.push_back(
          static_cast<std::uint16_t>(grid.Ring(first_row + row, first_column + column)));
    }
  }
  return window;
}

/// Of the rendered scenes' crossings 17 of 100 have nothing behind (turned scanner; 3 where rings
/// look down), 81 something far, 1 merges. The rarer ones a little more often, so that they count.
CrossingKind DrawKind(const Noise& noise, std::uint64_t index) {
  const double u = noise.Uniform(index);
  if (u < 0.2) return CrossingKind::kNoReturn;
  return u < 0.94 ? CrossingKind::kFar : CrossingKind::kMerged;
}

Cloud EmptyCloud(const BeamWindow& beams) {
  Cloud cloud;
  cloud.lines = beams.rows;
  cloud.beams = beams.columns;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  cloud.points.assign(beams.directions.size(), Eigen::Vector3f::Constant(nan));
  for (const Eigen::Vector3d& d : beams.directions) cloud.directions.emplace_back(d.cast<float>());
  cloud.intensity.resize(beams.directions.size());
  cloud.ring = beams.ring;
  return cloud;
}

class CloudSampler {
 public:
  CloudSampler(const TrueBoard& board, const Rigid3& lidar_from_target, const BeamModel& model,
               const ClassShifts& shifts, const Noise& noise)
      : board_(board),
        lidar_from_target_(lidar_from_target),
        model_(model),
        noise_(noise),
        next_(4 + kSides) {
    for (std::size_t side = 0; side < kSides; ++side) {
      behind_[side] = DrawKind(noise, side);
      shift_[side] = shifts[static_cast<std::size_t>(behind_[side]) - 1] +
                     model.side_sigma_rad * noise.Normal(4 + side);
    }
  }

  const std::array<CrossingKind, 4>& behind() const { return behind_; }

  struct Return {
    double range_m = 0;  ///< as measured; NaN: nothing returns
    double intensity = 0;
    bool on = false;  ///< the board stops it
  };

  Return Shoot(const Eigen::Vector3d& direction, int ring) {
    const PlanePlace beam = MeetBoard(board_, lidar_from_target_, direction, model_.beams_meet_m);
    Return back;
    back.range_m = Range(beam, ring, &back.on);
    if (std::isnan(back.range_m)) return back;
    const bool black = IsBlack(board_.target, beam.place);
    const double grey = back.on ? (black ? kBlack : kWhite) : kGrey;
    if (back.on && black) back.range_m += model_.dark_range_m;
    back.intensity = std::clamp(grey + kIntensitySigma * noise_.Normal(kShades + next_), 0.0, 1.0);
    return back;
  }

 private:
  static constexpr std::size_t kSides = 4;
  static constexpr std::uint64_t kShades = std::uint64_t{1} << 40;  // numbers of intensities' noise
  static constexpr double kBlack = 0.1, kWhite = 0.6, kGrey = 0.3, kIntensitySigma = 0.02;

  // Black and white alike.
  double Range(const PlanePlace& beam, int ring, bool* on) {
    const double offset = model_.range_offset_m + RingOffset(ring);
    const double blur = model_.blur_rad * noise_.Normal(next_++);
    const double ranging = model_.range_sigma_m * noise_.Normal(next_++) - offset;
    const double depth = noise_.Uniform(next_++);
    *on = false;
    if (!beam.ahead) return std::numeric_limits<double>::quiet_NaN();
    double farthest = -1e9;
    CrossingKind kind = CrossingKind::kFar;
    for (int side = 0; side < static_cast<int>(kSides); ++side) {
      const double beyond = Beyond(beam, side, blur);
      if (beyond <= farthest) continue;
      farthest = beyond;
      kind = behind_[static_cast<std::size_t>(side)];
    }
    *on = farthest <= 0;
    if (*on) return beam.range_m + ranging;
    // Uneven, so that what lies behind makes no plane of its own.
    const double measured = beam.range_m - offset;
    if (kind == CrossingKind::kFar) return measured + 1.5 + 2.5 * depth;
    if (kind == CrossingKind::kMerged) return measured + 0.2 + 0.25 * depth;
    return std::numeric_limits<double>::quiet_NaN();
  }

  double RingOffset(int ring) const {
    const auto i = static_cast<std::size_t>(ring);
    return i < model_.ring_offset_m.size() ? model_.ring_offset_m[i] : 0;
  }

  // How far a beam lies beyond a side that seems displaced.
  double Beyond(const PlanePlace& beam, int side, double blur) const {
    return SideNormal(side).dot(beam.place) - SideDistance(board_, side) -
           PerRadian(beam, side) * (shift_[static_cast<std::size_t>(side)] + blur) -
           PerThickness(beam, side) * model_.thickness_m;
  }

  const TrueBoard& board_;
  const Rigid3& lidar_from_target_;
  const BeamModel& model_;
  const Noise& noise_;
  std::uint64_t next_;  // number of the noise's stream
  std::array<CrossingKind, kSides> behind_{};
  std::array<double, kSides> shift_{};
};

}  // namespace

PlanePlace MeetBoard(const TrueBoard& board, const Rigid3& lidar_from_target,
                     const Eigen::Vector3d& direction, double beams_meet_m) {
  const Eigen::Quaterniond target_from_lidar = lidar_from_target.rotation.conjugate();
  const double height = -beams_meet_m * direction.z() / direction.head<2>().norm();
  const Eigen::Vector3d origin =
      target_from_lidar * (Eigen::Vector3d(0, 0, height) - lidar_from_target.translation);
  PlanePlace beam;
  beam.direction = target_from_lidar * direction;
  beam.ahead = beam.direction.z() > 0.02;
  // A millimetre of shape moves the place by less than its own slope of that.
  for (int step = 0; step < 3; ++step) {
    const double behind = step == 0 ? 0 : board.Behind(beam.place);
    beam.range_m = (behind - origin.z()) / beam.direction.z();
    beam.place = (origin + beam.range_m * beam.direction).head<2>();
  }
  return beam;
}

bool IsBlack(const Target& target, const Eigen::Vector2d& place) {
  const Eigen::Array2d squares(target.squares_x, target.squares_y);
  const Eigen::Array2d size = target.square_m * target.print_scale.array();
  const Eigen::Array2d at = (place - target.pattern_offset_m).array() / size + 0.5 * squares;
  if ((at < 0).any() || (at >= squares).any()) return true;
  return (static_cast<int>(at.x()) + static_cast<int>(at.y())) % 2 == 0;
}

Eigen::Vector2d SideNormal(int side) {
  constexpr int kX[] = {0, 1, 0, -1};
  constexpr int kY[] = {-1, 0, 1, 0};
  return {kX[side], kY[side]};
}

double SideDistance(const TrueBoard& board, int side) {
  return 0.5 * (side % 2 == 1 ? board.target.width_m : board.target.height_m) +
         board.beyond_m[static_cast<std::size_t>(side)];
}

double PerRadian(const PlanePlace& beam, int side) {
  const double sideways = SideNormal(side).dot(beam.direction.head<2>());
  return beam.range_m / std::sqrt(1 - sideways * sideways);
}

double PerThickness(const PlanePlace& beam, int side) {
  return std::max(0.0, -SideNormal(side).dot(beam.direction.head<2>()) / beam.direction.z());
}

ClassShifts DrawClassShifts(const BeamModel& model, const Noise& noise) {
  ClassShifts shifts;
  for (std::size_t k = 0; k < shifts.size(); ++k) {
    shifts[k] = model.class_sigma_rad * noise.Normal(k);
  }
  return shifts;
}

SampledCloud SampleCloud(const simulate::Options& lidar, const TrueBoard& board,
                         const Rigid3& lidar_from_target, const BeamModel& model,
                         const ClassShifts& shifts, const Noise& noise) {
  SampledCloud sampled;
  sampled.beams = WindowAbout(Grid(lidar), board.target, lidar_from_target);
  CloudSampler sampler(board, lidar_from_target, model, shifts, noise);
  sampled.behind = sampler.behind();
  sampled.cloud = EmptyCloud(sampled.beams);
  sampled.beams.on.resize(sampled.beams.directions.size());
  for (std::size_t i = 0; i < sampled.beams.directions.size(); ++i) {
    const auto back = sampler.Shoot(sampled.beams.directions[i], sampled.beams.ring[i]);
    sampled.beams.on[i] = back.on;
    sampled.cloud.points[i] = (back.range_m * sampled.beams.directions[i]).cast<float>();
    sampled.cloud.intensity[i] = static_cast<float>(back.intensity);
  }
  return sampled;
}

}  // namespace rgbdt::study
