#include "tests/study/bound.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <tuple>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/model/statistics.h"
#include "calib/simulate/lidar_options.h"
#include "tests/study/sampled_images.h"

namespace rgbdt::study {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Numbers of the unknowns. Each view has its own ten after what all views share.
constexpr Index kClasses = 3, kThickness = kClasses, kRangeOffset = kThickness + 1;
constexpr Index kPrint = kRangeOffset + 1, kCameras = kPrint + 2;
constexpr double kExactM = 1e-9;        // sigma of what is known
constexpr Index kSides = 6, kOwn = 10;  // of a view: pose, then sides

/// Where a row or column of beams leaves the board.
struct Leave {
  std::size_t last = 0;    ///< last beam on the board: the window's index
  int side = 0;            ///< that it crosses
  double width_m = 0;      ///< of the interval, across the side
  bool along_row = false;  ///< the two beams are neighbours in a row
  std::size_t gap = 0;     ///< the last beam's column (along a row) or row
  int of_beam = 1;         ///< crossings of the same side by the same last beam
  int in_gap = 1;          ///< crossings of the same side in the same gap
};

/// The side between two places on the board's plane, one on the board and one beyond: that which
/// both face most plainly. Nothing at the board's corners, where it may be either.
std::optional<int> SideBetween(const Target& target, const Eigen::Vector2d& in,
                               const Eigen::Vector2d& out) {
  const Eigen::Vector2d middle = 0.5 * (in + out);
  const Eigen::Vector2d step = out - in;
  std::optional<int> best;
  double nearest = 1e9;
  for (int side = 0; side < 4; ++side) {
    const Eigen::Vector2d normal = SideNormal(side);
    if (normal.dot(step) < 0.25 * step.norm()) continue;
    const Eigen::Vector2d along(-normal.y(), normal.x());
    if (std::abs(along.dot(middle)) > SideDistance(target, (side + 1) % 4) - 0.25 * step.norm()) {
      continue;
    }
    const double off = std::abs(normal.dot(middle) - SideDistance(target, side));
    if (off > nearest) continue;
    nearest = off;
    best = side;
  }
  return best;
}

class ViewCrossings {
 public:
  ViewCrossings(const Target& target, const SampledView& view) : target_(target), view_(view) {
    const BeamWindow& beams = view.beams;
    for (int row = 0; row < beams.rows; ++row) {
      AddLine(beams.At(row, 0), 1, beams.columns, true);
    }
    for (int column = 0; column < beams.columns; ++column) {
      AddLine(beams.At(0, column), static_cast<std::size_t>(beams.columns), beams.rows, false);
    }
    Count();
  }
  const std::vector<Leave>& leaves() const { return leaves_; }

 private:
  // Both ends of the board along a line of beams.
  void AddLine(std::size_t start, std::size_t step, int length, bool along_row) {
    int first = -1;
    int last = -1;
    for (int k = 0; k < length; ++k) {
      if (!view_.beams.on[start + static_cast<std::size_t>(k) * step]) continue;
      if (first < 0) first = k;
      last = k;
    }
    if (last <= first) return;
    const auto at = [&](int k) { return start + static_cast<std::size_t>(k) * step; };
    if (first > 0) Add(at(first), at(first - 1), along_row);
    if (last + 1 < length) Add(at(last), at(last + 1), along_row);
  }

  void Add(std::size_t in, std::size_t out, bool along_row) {
    const Eigen::Vector2d a = MeetPlane(view_.lidar_from_target, view_.beams.directions[in]).place;
    const Eigen::Vector2d b = MeetPlane(view_.lidar_from_target, view_.beams.directions[out]).place;
    const auto side = SideBetween(target_, a, b);
    if (!side) return;
    const auto columns = static_cast<std::size_t>(view_.beams.columns);
    Leave leave;
    leave.last = in;
    leave.side = *side;
    leave.width_m = SideNormal(*side).dot(b - a);
    leave.along_row = along_row;
    leave.gap = along_row ? in % columns : in / columns;
    leaves_.push_back(leave);
  }

  void Count() {
    std::map<std::pair<std::size_t, int>, int> beams;
    std::map<std::tuple<bool, std::size_t, int>, int> gaps;
    for (const Leave& leave : leaves_) {
      ++beams[{leave.last, leave.side}];
      ++gaps[{leave.along_row, leave.gap, leave.side}];
    }
    for (Leave& leave : leaves_) {
      leave.of_beam = beams[{leave.last, leave.side}];
      leave.in_gap = gaps[{leave.along_row, leave.gap, leave.side}];
    }
  }

  const Target& target_;
  const SampledView& view_;
  std::vector<Leave> leaves_;
};

/// Derivatives of a function of a pose by delta, the pose being Exp(delta) * pose.
MatrixXd ByDelta(const Rigid3& pose, const std::function<VectorXd(const Rigid3&)>& function) {
  constexpr double kStep = 1e-6;
  MatrixXd jacobian;
  for (Index k = 0; k < 6; ++k) {
    const Vector6d step = kStep * Vector6d::Unit(k);
    const VectorXd column =
        (function(Exp(step) * pose) - function(Exp(-step) * pose)) / (2 * kStep);
    if (k == 0) jacobian.resize(column.size(), 6);
    jacobian.col(k) = column;
  }
  return jacobian;
}

VectorXd ProjectedCorners(const Camera& camera, const Target& target,
                          const Rigid3& camera_from_target) {
  const std::vector<Eigen::Vector3d> corners = target.InnerCorners();
  VectorXd pixels(2 * static_cast<Index>(corners.size()));
  for (std::size_t i = 0; i < corners.size(); ++i) {
    pixels.segment<2>(2 * static_cast<Index>(i)) =
        camera.Project(camera_from_target * corners[i]).value();
  }
  return pixels;
}

/// Derivatives of the corners' pixels by the lens's numbers.
MatrixXd ByLens(const CameraSpec& spec, const Target& target, const Rigid3& camera_from_target) {
  MatrixXd by(2 * Index{target.corners_x()} * target.corners_y(), kLensNumbers);
  const auto at = [&](Index number, double step) {
    CameraSpec changed = spec;
    LensNumbers numbers = NumbersOf(spec.lens);
    numbers[number] += step;
    changed.lens = WithNumbers(spec.lens, numbers);
    return ProjectedCorners(Camera(changed), target, camera_from_target);
  };
  for (Index i = 0; i < kLensNumbers; ++i) {
    const double step = i < 4 ? 1e-3 : 1e-6;
    by.col(i) = (at(i, step) - at(i, -step)) / (2 * step);
  }
  return by;
}

/// The same by the pattern's width or height.
VectorXd ByPrint(const Camera& camera, Target target, const Rigid3& camera_from_target,
                 Index axis) {
  constexpr double kStep = 1e-6;
  target.print_scale[axis] += kStep;
  const VectorXd more = ProjectedCorners(camera, target, camera_from_target);
  target.print_scale[axis] -= 2 * kStep;
  return (more - ProjectedCorners(camera, target, camera_from_target)) / (2 * kStep);
}

/// Of the length of a vector of zero mean: from so many draws.
double MedianLength(const Eigen::Matrix3d& covariance) {
  constexpr std::size_t kDraws = 2001;
  const Eigen::Matrix3d root = covariance.llt().matrixL();
  const simulate::Noise noise(1, 0, "median length");
  std::vector<double> lengths;
  for (std::size_t i = 0; i < kDraws; ++i) {
    const Eigen::Vector3d draw(noise.Normal(3 * i), noise.Normal(3 * i + 1),
                               noise.Normal(3 * i + 2));
    lengths.push_back((root * draw).norm());
  }
  return Median(std::move(lengths));
}

class Bound {
 public:
  Bound(const SampledSession& session, BoundData data)
      : session_(session),
        data_(data),
        shared_(kCameras + kPoseAndLens * static_cast<Index>(session.rig.cameras.size())),
        information_(MatrixXd::Zero(shared_, shared_)) {
    const BeamModel& model = session.model;
    AddPrior(0, kClasses, model.class_sigma_rad, &information_);
    AddPrior(kThickness, 1, model.thickness_sigma_m, &information_);
    AddPrior(kRangeOffset, 1, std::max(kExactM, model.range_offset_sigma_m), &information_);
    AddPrior(kPrint, 2, std::max(kExactM, session.rig.target.print_sigma), &information_);
    for (std::size_t i = 0; i < session.rig.cameras.size(); ++i) {
      const LensUncertainty lens = session.rig.cameras[i].LensUncertaintyOrUsual();
      for (Index k = 0; k < kLensNumbers; ++k) {
        const double sigma = std::max(kExactM, std::sqrt(lens.covariance(k, k)));
        AddPrior(CameraAt(i) + 6 + k, 1, sigma, &information_);
      }
    }
    for (const SampledView& view : session.views) {
      if (!view.heldout) AddView(view);
    }
  }

  std::map<std::string, CameraBound> Run() const {
    const MatrixXd covariance = information_.ldlt().solve(MatrixXd::Identity(shared_, shared_));
    std::map<std::string, CameraBound> bounds;
    for (std::size_t i = 0; i < session_.rig.cameras.size(); ++i) {
      const Index at = CameraAt(i);
      CameraBound& bound = bounds[session_.rig.cameras[i].name];
      bound.covariance = covariance.block<6, 6>(at, at);
      const Eigen::Matrix3d rotation = bound.covariance.topLeftCorner<3, 3>();
      // The camera's centre moves as far as delta's translation.
      const Eigen::Matrix3d centre = bound.covariance.bottomRightCorner<3, 3>();
      bound.rotation_deg = std::sqrt(rotation.trace()) / simulate::kDegree;
      bound.rotation_deg_median = MedianLength(rotation) / simulate::kDegree;
      bound.centre_mm = 1e3 * std::sqrt(centre.trace());
      bound.centre_mm_median = 1e3 * MedianLength(centre);
    }
    return bounds;
  }

 private:
  // Of its pose; its lens follows.
  static Index CameraAt(std::size_t camera) {
    return kCameras + kPoseAndLens * static_cast<Index>(camera);
  }

  static void AddPrior(Index first, Index count, double sigma, MatrixXd* information) {
    information->diagonal().segment(first, count).array() += 1 / (sigma * sigma);
  }

  // What a view tells of what all views share, its own unknowns eliminated.
  void AddView(const SampledView& view) {
    MatrixXd view_information = MatrixXd::Zero(shared_ + kOwn, shared_ + kOwn);
    AddPrior(shared_ + kSides, 4, session_.model.side_sigma_rad, &view_information);
    for (std::size_t i = 0; i < session_.rig.cameras.size(); ++i) {
      AddCorners(view, i, &view_information);
    }
    AddRanges(view, &view_information);
    if (data_ == BoundData::kAll) AddCrossings(view, &view_information);
    const MatrixXd cross = view_information.topRightCorner(shared_, kOwn);
    information_ +=
        view_information.topLeftCorner(shared_, shared_) -
        cross * view_information.bottomRightCorner(kOwn, kOwn).ldlt().solve(cross.transpose());
  }

  void AddCorners(const SampledView& view, std::size_t index, MatrixXd* information) const {
    const CameraSpec& spec = session_.true_cameras[index];
    const Camera camera(spec);
    const Target& target = session_.true_target;
    const Rigid3& lidar_from_target = view.lidar_from_target;
    const Rigid3& camera_from_lidar = session_.truth.camera_from_lidar.at(spec.name);
    MatrixXd j = MatrixXd::Zero(2 * Index{target.corners_x()} * target.corners_y(), shared_ + kOwn);
    j.middleCols<6>(CameraAt(index)) = ByDelta(camera_from_lidar, [&](const Rigid3& pose) {
      return ProjectedCorners(camera, target, pose * lidar_from_target);
    });
    j.middleCols<6>(shared_) = ByDelta(lidar_from_target, [&](const Rigid3& pose) {
      return ProjectedCorners(camera, target, camera_from_lidar * pose);
    });
    j.middleCols<kLensNumbers>(CameraAt(index) + 6) =
        ByLens(spec, target, camera_from_lidar * lidar_from_target);
    for (Index axis = 0; axis < 2; ++axis) {
      j.col(kPrint + axis) = ByPrint(camera, target, camera_from_lidar * lidar_from_target, axis);
    }
    const auto corners = TrueCorners(spec, target, camera_from_lidar * lidar_from_target);
    *information +=
        j.transpose() * CornerCovariance(corners.value(), CornerSigma(spec.kind)).ldlt().solve(j);
  }

  // Beams on the board whose ranges are trusted.
  std::vector<std::size_t> Inner(const SampledView& view) const {
    std::vector<std::size_t> inner;
    for (std::size_t i = 0; i < view.beams.on.size(); ++i) {
      if (!view.beams.on[i]) continue;
      const Eigen::Vector2d place =
          MeetPlane(view.lidar_from_target, view.beams.directions[i]).place;
      bool within = true;
      for (int side = 0; side < 4; ++side) {
        within &= SideNormal(side).dot(place) <
                  SideDistance(session_.rig.target, side) - session_.model.rim_m;
      }
      if (within) inner.push_back(i);
    }
    return inner;
  }

  void AddRanges(const SampledView& view, MatrixXd* information) const {
    const std::vector<std::size_t> inner = Inner(view);
    MatrixXd j = MatrixXd::Zero(static_cast<Index>(inner.size()), shared_ + kOwn);
    j.col(kRangeOffset).setConstant(-1);
    j.middleCols<6>(shared_) = ByDelta(view.lidar_from_target, [&](const Rigid3& pose) {
      VectorXd ranges(static_cast<Index>(inner.size()));
      for (std::size_t i = 0; i < inner.size(); ++i) {
        ranges[static_cast<Index>(i)] = MeetPlane(pose, view.beams.directions[inner[i]]).range_m;
      }
      return ranges;
    });
    const double sigma = session_.model.range_sigma_m;
    *information += j.transpose() * j / (sigma * sigma);
  }

  void AddCrossings(const SampledView& view, MatrixXd* information) const {
    const ViewCrossings crossings(session_.rig.target, view);
    const std::vector<Leave>& leaves = crossings.leaves();
    const auto count = static_cast<Index>(leaves.size());
    MatrixXd j = MatrixXd::Zero(count, shared_ + kOwn);
    j.middleCols<6>(shared_) = ByDelta(view.lidar_from_target, [&](const Rigid3& pose) {
      VectorXd places(count);
      for (Index i = 0; i < count; ++i) {
        const Leave& leave = leaves[static_cast<std::size_t>(i)];
        places[i] =
            SideNormal(leave.side).dot(MeetPlane(pose, view.beams.directions[leave.last]).place);
      }
      return places;
    });
    for (Index i = 0; i < count; ++i) {
      const Leave& leave = leaves[static_cast<std::size_t>(i)];
      const PlanePlace beam = MeetPlane(view.lidar_from_target, view.beams.directions[leave.last]);
      const auto side = static_cast<std::size_t>(leave.side);
      const double per_radian = PerRadian(beam, leave.side);
      j(i, static_cast<Index>(view.behind[side]) - 1) = -per_radian;
      j(i, shared_ + kSides + leave.side) = -per_radian;
      j(i, kThickness) = -PerThickness(beam, leave.side);
      const double blur = session_.model.blur_rad * per_radian;
      const double variance =
          leave.of_beam * (leave.in_gap * leave.width_m * leave.width_m / 12 + blur * blur);
      j.row(i) /= std::sqrt(variance);
    }
    *information += j.transpose() * j;
  }

  const SampledSession& session_;
  BoundData data_;
  Index shared_;
  MatrixXd information_;
};

}  // namespace

std::map<std::string, CameraBound> BoundOf(const SampledSession& session, BoundData data) {
  return Bound(session, data).Run();
}

}  // namespace rgbdt::study
