#include "calib/sync/internal/motion_equations.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "calib/sync/internal/motion_costs.h"

namespace rgbdt::sync {
namespace {

// A read-out is known to be less than some times this before anything is measured [s].
constexpr double kRollingSigma = 0.2;
// An offset's change from one place of a changing clock to the next [s], and that of its first
// place: only what holds places that no image reaches.
constexpr double kChangeSigma = 2 * kToldChange;
constexpr double kFirstChangeSigma = 1;
// Of an image's or sweep's dozen of residuals together: beyond this [sigma] it counts less, but
// for while most are off by more.
constexpr double kHuber = 6;

double HuberOf(std::vector<double> norms) { return std::max(kHuber, 3 * Median(std::move(norms))); }

}  // namespace

MotionEquations::MotionEquations(const MotionData& data, const MotionState& state)
    : data_(data), state_(state), knots_(state.way.knots.size(), Knot{}) {
  AddWay();
  cameras_.resize(data.cameras.size());
  image_blocks_.resize(data.cameras.size());
  facts_.camera_misfits.resize(data.cameras.size());
  for (std::size_t camera = 0; camera < cameras_.size(); ++camera) AddImages(camera);
  std::sort(image_seconds_.begin(), image_seconds_.end());
  AddSweeps();
  AddPriors();
}

void MotionEquations::AddWay() {
  for (Knot& knot : knots_) problem_.AddParameterBlock(knot.data(), 6);
  for (std::size_t i = 0; i + 3 < knots_.size(); ++i) {
    problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<JerkCost, 6, 6, 6, 6, 6>(new JerkCost{
                                  state_.way.KnotsOf(static_cast<int>(i)), state_.way.step_s}),
                              nullptr, knots_[i].data(), knots_[i + 1].data(), knots_[i + 2].data(),
                              knots_[i + 3].data());
  }
}

void MotionEquations::AddImages(std::size_t index) {
  const CameraData& data = data_.cameras[index];
  const CameraState& state = state_.cameras[index];
  CameraUnknowns& unknowns = cameras_[index];
  unknowns.changes.assign(std::max<std::size_t>(2, state.changes_s.size()), 0.0);
  problem_.AddParameterBlock(unknowns.pose.data(), 6);
  for (double* one : {&unknowns.offset, &unknowns.rolling}) problem_.AddParameterBlock(one, 1);
  for (double& change : unknowns.changes) {
    problem_.AddParameterBlock(&change, 1);
    if (!data_.clocks_change) problem_.SetParameterBlockConstant(&change);
  }
  if (data_.clocks_change) problem_.SetParameterBlockConstant(&unknowns.offset);
  const Trajectory& way = state_.way;
  struct Block {
    std::unique_ptr<ImageCost> cost;
    std::size_t segment, place;
  };
  std::vector<Block> blocks;
  std::vector<double> norms;
  for (const PosedImage& image : data.images) {
    const double seconds = state_.SecondsOf(index, image, data_.clock_step_s);
    const int segment = way.Segment(seconds);
    const double within = way.Within(seconds, segment);
    // Beyond the way's ends nothing holds it.
    if (within < -0.5 || within > 1.5) continue;
    const auto [place, share] =
        ClockPlace(state_.ByClock(index, image), data_.clock_step_s, unknowns.changes.size());
    auto cost = std::make_unique<ImageCost>();
    cost->knots = way.KnotsOf(segment);
    cost->camera_from_lidar = state.camera_from_lidar;
    cost->within = within;
    cost->step_s = way.step_s;
    cost->middle_row = image.middle_row;
    cost->share = share;
    cost->rolling_s = state.rolling_s;
    cost->predicted = state.camera_from_lidar * way.At(seconds);
    cost->predicted_by_row =
        state.rolling_s * (Adjoint(state.camera_from_lidar) * way.TwistAt(seconds));
    cost->factor = data.variance_factor;
    const auto at = [&](double later) {
      return state.camera_from_lidar * way.At(seconds + later * state.rolling_s);
    };
    cost->quadratic = LineariseImage(data.camera, data_.target, image, data.sigma_px, at);
    facts_.camera_misfits[index].point_chi2 += cost->quadratic.misfit;
    facts_.camera_misfits[index].points += cost->quadratic.rows - cost->quadratic.rank;
    facts_.camera_misfits[index].freedom += cost->quadratic.rank;
    norms.push_back(cost->quadratic.rest.norm() / std::sqrt(cost->factor));
    blocks.push_back(
        {std::move(cost), static_cast<std::size_t>(segment), static_cast<std::size_t>(place)});
    image_seconds_.push_back(seconds);
  }
  const double huber = HuberOf(std::move(norms));
  for (Block& block : blocks) {
    const std::size_t i = block.segment;
    const std::size_t p = block.place;
    auto* function =
        new ceres::AutoDiffCostFunction<ImageCost, Quadratic::kSize, 6, 6, 6, 6, 6, 1, 1, 1, 1>(
            block.cost.release());
    image_blocks_[index].push_back(problem_.AddResidualBlock(
        function, new ceres::HuberLoss(huber), knots_[i].data(), knots_[i + 1].data(),
        knots_[i + 2].data(), knots_[i + 3].data(), unknowns.pose.data(), &unknowns.offset,
        &unknowns.changes[p], &unknowns.changes[p + 1], &unknowns.rolling));
  }
}

// Whether images hold the way at this time.
bool MotionEquations::SeenAt(double seconds) const {
  const auto after = std::lower_bound(image_seconds_.begin(), image_seconds_.end(), seconds);
  if (after == image_seconds_.begin() || after == image_seconds_.end()) return false;
  return *after - *(after - 1) < data_.most_gap_s;
}

void MotionEquations::AddSweeps() {
  problem_.AddParameterBlock(&range_, 1);
  const Trajectory& way = state_.way;
  std::vector<SweepMotion> motions;
  std::vector<double> norms;
  for (const WavedSweep& sweep : data_.sweeps) {
    auto motion = LineariseSweep(sweep, data_.target, way, state_.range_offset_m, data_.on_board);
    if (!motion || !SeenAt(motion->seconds)) continue;
    norms.push_back(motion->quadratic.rest.norm() / std::sqrt(data_.sweep_variance_factor));
    motions.push_back(std::move(*motion));
  }
  const double huber = HuberOf(std::move(norms));
  for (const SweepMotion& motion : motions) {
    const int segment = way.Segment(motion.seconds);
    const auto i = static_cast<std::size_t>(segment);
    auto* function = new ceres::AutoDiffCostFunction<SweepCost, Quadratic::kSize, 6, 6, 6, 6, 1>(
        new SweepCost{way.KnotsOf(segment), way.Within(motion.seconds, segment), way.step_s, motion,
                      data_.sweep_variance_factor});
    sweep_blocks_.push_back(problem_.AddResidualBlock(
        function, new ceres::HuberLoss(huber), knots_[i].data(), knots_[i + 1].data(),
        knots_[i + 2].data(), knots_[i + 3].data(), &range_));
    facts_.sweep_misfit.point_chi2 += motion.quadratic.misfit;
    facts_.sweep_misfit.points += motion.quadratic.rows - motion.quadratic.rank;
    facts_.sweep_misfit.freedom += motion.quadratic.rank;
    if (facts_.sweeps == 0) facts_.first_s = motion.seconds;
    facts_.last_s = motion.seconds;
    ++facts_.sweeps;
  }
}

void MotionEquations::AddChangePriors(const std::vector<double>& now,
                                      std::vector<double>* changes) {
  problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<ScalarPrior, 1, 1>(
                                new ScalarPrior{now[0], kFirstChangeSigma}),
                            nullptr, changes->data());
  for (std::size_t k = 0; k + 1 < now.size(); ++k) {
    problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<ChangePrior, 1, 1, 1>(
                                  new ChangePrior{now[k + 1] - now[k], kChangeSigma}),
                              nullptr, &(*changes)[k], &(*changes)[k + 1]);
  }
}

void MotionEquations::AddPriors() {
  for (std::size_t index = 0; index < cameras_.size(); ++index) {
    const CameraData& data = data_.cameras[index];
    const CameraState& state = state_.cameras[index];
    problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<ScalarPrior, 1, 1>(
                                  new ScalarPrior{state.rolling_s, kRollingSigma}),
                              nullptr, &cameras_[index].rolling);
    if (data_.clocks_change) AddChangePriors(state.changes_s, &cameras_[index].changes);
    if (!data.prior_pose) continue;
    if (data.prior_covariance.isZero()) {
      problem_.SetParameterBlockConstant(cameras_[index].pose.data());
      continue;
    }
    const Matrix6d information = data.prior_covariance.inverse();
    const Matrix6d root = information.llt().matrixU();
    problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<PosePrior, 6, 6>(
                                  new PosePrior{state.camera_from_lidar, *data.prior_pose, root}),
                              nullptr, cameras_[index].pose.data());
  }
  if (data_.range_offset_sigma_m > 0) {
    problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<ScalarPrior, 1, 1>(new ScalarPrior{
                                  state_.range_offset_m, data_.range_offset_sigma_m}),
                              nullptr, &range_);
  } else {
    problem_.SetParameterBlockConstant(&range_);
  }
}

bool MotionEquations::Step(MotionState* state, double* moved_s) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.num_threads = 1;
  // All knots moved in time together cost little against any single one's: damping that counts for
  // these would hold that.
  options.initial_trust_region_radius = 1e8;
  options.max_num_iterations = 8;  // it is made anew about the result
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem_, &summary);
  if (!summary.IsSolutionUsable()) return false;
  for (std::size_t i = 0; i < knots_.size(); ++i) {
    const Pose<double> moved = MovedKnot(state->way.knots[i], knots_[i].data());
    state->way.knots[i] = {moved.rotation.normalized(), moved.translation};
  }
  *moved_s = 0;
  for (std::size_t c = 0; c < cameras_.size(); ++c) {
    const CameraUnknowns& unknowns = cameras_[c];
    CameraState& camera = state->cameras[c];
    const Eigen::Map<const Eigen::Vector3d> turn(unknowns.pose.data());
    const Eigen::Map<const Eigen::Vector3d> shift(unknowns.pose.data() + 3);
    camera.camera_from_lidar = Rigid3{ExpRotation<double>(turn), shift} * camera.camera_from_lidar;
    camera.offset_s += unknowns.offset;
    camera.rolling_s += unknowns.rolling;
    *moved_s = std::max({*moved_s, std::abs(unknowns.offset), std::abs(unknowns.rolling)});
    for (std::size_t k = 0; k < camera.changes_s.size(); ++k) {
      camera.changes_s[k] += unknowns.changes[k];
      *moved_s = std::max(*moved_s, std::abs(unknowns.changes[k]));
    }
  }
  state->range_offset_m += range_;
  return true;
}

}  // namespace rgbdt::sync
