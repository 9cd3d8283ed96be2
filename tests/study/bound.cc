#include "tests/study/bound.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/model/statistics.h"
#include "calib/simulate/lidar_options.h"
#include "tests/study/board_leaves.h"
#include "tests/study/sampled_images.h"

namespace rgbdt::study {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Numbers of the unknowns; rings follow, if they differ, then cameras. Each view has its own ten
// after what all views share.
constexpr Index kClasses = 3, kThickness = kClasses, kRangeOffset = kThickness + 1;
constexpr Index kDark = kRangeOffset + 1, kBeamsMeet = kDark + 1;
constexpr Index kPrint = kBeamsMeet + 1, kBow = kPrint + 2, kOutline = kBow + 3;
constexpr Index kRings = kOutline + 4;
constexpr double kExactM = 1e-9;        // sigma of what is known
constexpr Index kSides = 6, kOwn = 10;  // of a view: pose, then sides

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

Index CornerNumbers(const TrueBoard& board) {
  return 2 * Index{board.target.corners_x()} * board.target.corners_y();
}

VectorXd ProjectedCorners(const Camera& camera, const TrueBoard& board,
                          const Rigid3& camera_from_target) {
  const std::vector<Eigen::Vector3d> corners = board.InnerCorners();
  VectorXd pixels(2 * static_cast<Index>(corners.size()));
  for (std::size_t i = 0; i < corners.size(); ++i) {
    pixels.segment<2>(2 * static_cast<Index>(i)) =
        camera.Project(camera_from_target * corners[i]).value();
  }
  return pixels;
}

/// Derivatives of the corners' pixels by the lens's numbers.
MatrixXd ByLens(const CameraSpec& spec, const TrueBoard& board, const Rigid3& camera_from_target) {
  MatrixXd by(CornerNumbers(board), kLensNumbers);
  const auto at = [&](Index number, double step) {
    CameraSpec changed = spec;
    LensNumbers numbers = NumbersOf(spec.lens);
    numbers[number] += step;
    changed.lens = WithNumbers(spec.lens, numbers);
    return ProjectedCorners(Camera(changed), board, camera_from_target);
  };
  for (Index i = 0; i < kLensNumbers; ++i) {
    const double step = i < 4 ? 1e-3 : 1e-6;
    by.col(i) = (at(i, step) - at(i, -step)) / (2 * step);
  }
  return by;
}

/// Derivatives of what depends on the board by one of its numbers.
VectorXd ByNumber(const TrueBoard& board, const std::function<double*(TrueBoard*)>& number,
                  const std::function<VectorXd(const TrueBoard&)>& function) {
  constexpr double kStep = 1e-6;
  const auto at = [&](double step) {
    TrueBoard changed = board;
    *number(&changed) += step;
    return function(changed);
  };
  return (at(kStep) - at(-kStep)) / (2 * kStep);
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
        rings_(static_cast<Index>(session.model.ring_offset_m.size())),
        shared_(kRings + rings_ + kPoseAndLens * static_cast<Index>(session.rig.cameras.size())),
        information_(MatrixXd::Zero(shared_, shared_)) {
    const BeamModel& model = session.model;
    AddPrior(0, kClasses, model.class_prior_rad, &information_);
    AddPrior(kThickness, 1, model.thickness_sigma_m, &information_);
    AddPrior(kRangeOffset, 1, std::max(kExactM, model.range_offset_sigma_m), &information_);
    AddPrior(kDark, 1, std::max(kExactM, model.dark_range_sigma_m), &information_);
    AddPrior(kBeamsMeet, 1, std::max(kExactM, model.beams_meet_sigma_m), &information_);
    AddPrior(kOutline, 4, std::max(kExactM, model.outline_sigma_m), &information_);
    AddPrior(kRings, rings_, std::max(kExactM, model.ring_offset_sigma_m), &information_);
    const double print_sigma = session.rig.target.print_sigma;
    AddPrior(kPrint, 2, std::max(kExactM, print_sigma), &information_);
    AddPrior(kBow, 3, print_sigma > 0 ? kBowSigmaM : kExactM, &information_);
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
  Index CameraAt(std::size_t camera) const {
    return kRings + rings_ + kPoseAndLens * static_cast<Index>(camera);
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
    const TrueBoard& board = session_.true_board;
    const Rigid3& lidar_from_target = view.lidar_from_target;
    const Rigid3& camera_from_lidar = session_.truth.camera_from_lidar.at(spec.name);
    MatrixXd j = MatrixXd::Zero(CornerNumbers(board), shared_ + kOwn);
    j.middleCols<6>(CameraAt(index)) = ByDelta(camera_from_lidar, [&](const Rigid3& pose) {
      return ProjectedCorners(camera, board, pose * lidar_from_target);
    });
    j.middleCols<6>(shared_) = ByDelta(lidar_from_target, [&](const Rigid3& pose) {
      return ProjectedCorners(camera, board, camera_from_lidar * pose);
    });
    j.middleCols<kLensNumbers>(CameraAt(index) + 6) =
        ByLens(spec, board, camera_from_lidar * lidar_from_target);
    const auto of_board = [&](const TrueBoard& of) {
      return ProjectedCorners(camera, of, camera_from_lidar * lidar_from_target);
    };
    for (Index axis = 0; axis < 2; ++axis) {
      j.col(kPrint + axis) = ByNumber(
          board, [=](TrueBoard* of) { return &of->target.print_scale[axis]; }, of_board);
    }
    AddBow(of_board, &j);
    const auto corners = TrueCorners(spec, board, camera_from_lidar * lidar_from_target);
    *information +=
        j.transpose() * CornerCovariance(corners.value(), CornerSigma(spec.kind)).ldlt().solve(j);
  }

  PlanePlace Meet(const SampledView& view, std::size_t beam) const {
    return MeetBoard(session_.true_board, view.lidar_from_target, view.beams.directions[beam],
                     session_.model.beams_meet_m);
  }

  void AddBow(const std::function<VectorXd(const TrueBoard&)>& of_board, MatrixXd* j) const {
    for (Index k = 0; k < 3; ++k) {
      j->col(kBow + k) = ByNumber(
          session_.true_board, [=](TrueBoard* of) { return &of->bow_m[k]; }, of_board);
    }
  }

  // What a view's beams have, by the board's shape and pose and by where beams meet.
  using OfBeams =
      std::function<VectorXd(const TrueBoard& board, const Rigid3& pose, double beams_meet_m)>;
  void AddBoardAndMeet(const SampledView& view, const OfBeams& of, MatrixXd* j) const {
    constexpr double kStepM = 1e-5;
    const double meet = session_.model.beams_meet_m;
    const TrueBoard& board = session_.true_board;
    const Rigid3& at = view.lidar_from_target;
    j->middleCols<6>(shared_) =
        ByDelta(at, [&](const Rigid3& pose) { return of(board, pose, meet); });
    j->col(kBeamsMeet) =
        (of(board, at, meet + kStepM) - of(board, at, meet - kStepM)) / (2 * kStepM);
    AddBow([&](const TrueBoard& bent) { return of(bent, at, meet); }, j);
  }

  // Beams on the board whose ranges are trusted.
  std::vector<std::size_t> Inner(const SampledView& view) const {
    std::vector<std::size_t> inner;
    for (std::size_t i = 0; i < view.beams.on.size(); ++i) {
      if (!view.beams.on[i]) continue;
      const Eigen::Vector2d place = Meet(view, i).place;
      bool within = true;
      for (int side = 0; side < 4; ++side) {
        within &= SideNormal(side).dot(place) <
                  SideDistance(session_.true_board, side) - session_.model.rim_m;
      }
      if (within) inner.push_back(i);
    }
    return inner;
  }

  void AddRanges(const SampledView& view, MatrixXd* information) const {
    const std::vector<std::size_t> inner = Inner(view);
    MatrixXd j = MatrixXd::Zero(static_cast<Index>(inner.size()), shared_ + kOwn);
    j.col(kRangeOffset).setConstant(-1);
    for (std::size_t i = 0; i < inner.size(); ++i) {
      const auto row = static_cast<Index>(i);
      j(row, kDark) = IsBlack(session_.true_board.target, Meet(view, inner[i]).place) ? 1 : 0;
      if (rings_ > 0) j(row, kRings + view.beams.ring[inner[i]]) = -1;
    }
    const auto ranges = [&](const TrueBoard& board, const Rigid3& pose, double beams_meet_m) {
      VectorXd of(static_cast<Index>(inner.size()));
      for (std::size_t i = 0; i < inner.size(); ++i) {
        of[static_cast<Index>(i)] =
            MeetBoard(board, pose, view.beams.directions[inner[i]], beams_meet_m).range_m;
      }
      return of;
    };
    AddBoardAndMeet(view, ranges, &j);
    const double sigma = session_.model.range_sigma_m;
    *information += j.transpose() * j / (sigma * sigma);
  }

  void AddCrossings(const SampledView& view, MatrixXd* information) const {
    const std::vector<Leave> leaves =
        LeavesOf(session_.true_board, session_.model.beams_meet_m, view);
    const auto count = static_cast<Index>(leaves.size());
    MatrixXd j = MatrixXd::Zero(count, shared_ + kOwn);
    const auto places = [&](const TrueBoard& board, const Rigid3& pose, double beams_meet_m) {
      VectorXd of(count);
      for (Index i = 0; i < count; ++i) {
        const Leave& leave = leaves[static_cast<std::size_t>(i)];
        of[i] =
            SideNormal(leave.side)
                .dot(MeetBoard(board, pose, view.beams.directions[leave.last], beams_meet_m).place);
      }
      return of;
    };
    AddBoardAndMeet(view, places, &j);
    for (Index i = 0; i < count; ++i) {
      const Leave& leave = leaves[static_cast<std::size_t>(i)];
      const PlanePlace beam = Meet(view, leave.last);
      const auto side = static_cast<std::size_t>(leave.side);
      const double per_radian = PerRadian(beam, leave.side);
      j(i, static_cast<Index>(view.behind[side]) - 1) = -per_radian;
      j(i, shared_ + kSides + leave.side) = -per_radian;
      j(i, kThickness) = -PerThickness(beam, leave.side);
      j(i, kOutline + leave.side) = -1;
      const double blur = session_.model.blur_rad * per_radian;
      const double variance =
          leave.of_beam * (leave.in_gap * leave.width_m * leave.width_m / 12 + blur * blur);
      j.row(i) /= std::sqrt(variance);
    }
    *information += j.transpose() * j;
  }

  const SampledSession& session_;
  BoundData data_;
  Index rings_;  // that have an offset of their own
  Index shared_;
  MatrixXd information_;
};

}  // namespace

std::map<std::string, CameraBound> BoundOf(const SampledSession& session, BoundData data) {
  return Bound(session, data).Run();
}

}  // namespace rgbdt::study
