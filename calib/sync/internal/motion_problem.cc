#include "calib/sync/internal/motion_problem.h"

#include <ceres/ceres.h>

#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>

namespace rgbdt::sync {
namespace {

using Knot = std::array<double, 6>;

// How the board's way changes its acceleration is noise of so much at each knot: some times what a
// person's arms do, so that it only bridges what no sensor sees.
constexpr double kJerk = 100;      // [m/s^3]
constexpr double kTurnJerk = 200;  // [rad/s^3]
// A read-out is known to be less than some times this before anything is measured [s].
constexpr double kRollingSigma = 0.2;
// An offset's change from one place of a changing clock to the next [s], and that of its first
// place: only what holds places that no image reaches.
constexpr double kChangeSigma = 2 * kToldChange;
constexpr double kFirstChangeSigma = 1;
constexpr int kMostRounds = 25;
constexpr double kAtRest = 2e-6;  // [s] that offsets and read-outs move by
// Likewise of a changing clock's places, about a jump of which nothing fits: less than is known.
constexpr double kChangesAtRest = 2e-4;
// Of an image's or sweep's dozen of residuals together: beyond this [sigma] it counts less, but
// for while most are off by more.
constexpr double kHuber = 6;

double Interpolated(const std::vector<double>& changes, int from, double share) {
  if (changes.empty()) return 0;
  const auto i = static_cast<std::size_t>(from);
  return (1 - share) * changes[i] + share * changes[i + 1];
}

double HuberOf(std::vector<double> norms) { return std::max(kHuber, 3 * Median(std::move(norms))); }

// Between which two places of the clock a time lies, and how far beyond the first.
std::pair<int, double> ClockPlace(double seconds, double step_s, std::size_t places) {
  const int from = static_cast<int>(std::clamp(std::floor(seconds / step_s), 0.0,
                                               std::max(0.0, static_cast<double>(places) - 2)));
  return {from, std::clamp(seconds / step_s - from, 0.0, 1.0)};
}

template <typename T>
std::array<Pose<T>, 4> Moved(const std::array<Rigid3, 4>& base, const T* a, const T* b, const T* c,
                             const T* d) {
  return {MovedKnot(base[0], a), MovedKnot(base[1], b), MovedKnot(base[2], c),
          MovedKnot(base[3], d)};
}

template <typename T, typename Vector>
void Weigh(const Quadratic& quadratic, double factor, const Vector& xi, T* residuals) {
  for (int i = 0; i < Quadratic::kSize; ++i) {
    T sum = T(quadratic.rest[i]);
    for (int k = 0; k < Quadratic::kSize; ++k) sum += quadratic.root(i, k) * xi[k];
    residuals[i] = sum / std::sqrt(factor);
  }
}

// An image: the board at its time, through the camera, against what its corners tell.
struct ImageCost {
  std::array<Rigid3, 4> knots;
  Rigid3 camera_from_lidar;
  double within = 0, step_s = 0;  // at unknowns of zero
  double middle_row = 0, share = 0;
  double rolling_s = 0;
  Rigid3 predicted;  // camera_from_target, about which `quadratic` is
  Vector6d predicted_by_row;
  Quadratic quadratic;
  double factor = 1;

  template <typename T>
  bool operator()(const T* a, const T* b, const T* c, const T* d, const T* pose, const T* offset,
                  const T* change_from, const T* change_to, const T* rolling, T* residuals) const {
    const auto moved = Moved(knots, a, b, c, d);
    const Pose<T> camera = [&] {
      const Vector3<T> turn(pose[0], pose[1], pose[2]);
      const Vector3<T> shift(pose[3], pose[4], pose[5]);
      return Pose<T>{ExpRotation(turn), shift} * Cast<T>(camera_from_lidar);
    }();
    const T later =
        offset[0] + (1 - share) * change_from[0] + share * change_to[0] + rolling[0] * middle_row;
    const T u = T(within) + later / step_s;
    const Pose<T> at = camera * SplineAt(moved, u);
    const Pose<T> before = camera * SplineAt<T>(moved, u - kHalfInterval);
    const Pose<T> after = camera * SplineAt<T>(moved, u + kHalfInterval);
    const Eigen::Matrix<T, 6, 1> by_row =
        TwistBetween(before, after, kHalfInterval * step_s) * (rolling_s + rolling[0]);
    Eigen::Matrix<T, Quadratic::kSize, 1> xi;
    xi << SmallLog(at * Cast<T>(predicted.Inverse())), by_row - predicted_by_row.cast<T>(), T(0);
    Weigh(quadratic, factor, xi, residuals);
    return true;
  }
};

// A sweep: the board at its time and its motion, against what the points tell.
struct SweepCost {
  std::array<Rigid3, 4> knots;
  double within = 0, step_s = 0;
  SweepMotion motion;
  double factor = 1;

  template <typename T>
  bool operator()(const T* a, const T* b, const T* c, const T* d, const T* range,
                  T* residuals) const {
    const auto moved = Moved(knots, a, b, c, d);
    const Pose<T> at = SplineAt<T>(moved, T(within));
    const Pose<T> before = SplineAt<T>(moved, T(within - kHalfInterval));
    const Pose<T> after = SplineAt<T>(moved, T(within + kHalfInterval));
    Eigen::Matrix<T, Quadratic::kSize, 1> xi;
    xi << SmallLog(at * Cast<T>(motion.lidar_from_target.Inverse())),
        TwistBetween(before, after, kHalfInterval * step_s) - motion.twist.cast<T>(), range[0];
    Weigh(motion.quadratic, factor, xi, residuals);
    return true;
  }
};

// Four knots in a row: third differences of places and of rotations.
struct JerkCost {
  std::array<Rigid3, 4> knots;
  double step_s = 0;

  template <typename T>
  bool operator()(const T* a, const T* b, const T* c, const T* d, T* residuals) const {
    const auto k = Moved(knots, a, b, c, d);
    const double cube = step_s * step_s * step_s;
    const Vector3<T> jerk =
        (k[3].translation - T(3) * k[2].translation + T(3) * k[1].translation - k[0].translation) /
        T(cube * kJerk);
    Vector3<T> turn[3];
    for (std::size_t i = 0; i < 3; ++i) {
      turn[i] = LogRotation<T>(k[i].rotation.conjugate() * k[i + 1].rotation);
    }
    const Vector3<T> turn_jerk = (turn[2] - T(2) * turn[1] + turn[0]) / T(cube * kTurnJerk);
    for (int i = 0; i < 3; ++i) {
      residuals[i] = jerk[i];
      residuals[3 + i] = turn_jerk[i];
    }
    return true;
  }
};

struct PosePrior {
  Rigid3 camera_from_lidar, prior;
  Matrix6d root;  // root^T root is the information

  template <typename T>
  bool operator()(const T* pose, T* residuals) const {
    const Vector3<T> turn(pose[0], pose[1], pose[2]);
    const Vector3<T> shift(pose[3], pose[4], pose[5]);
    const Pose<T> moved = Pose<T>{ExpRotation(turn), shift} * Cast<T>(camera_from_lidar);
    const Eigen::Matrix<T, 6, 1> off = SmallLog(moved * Cast<T>(prior.Inverse()));
    for (int i = 0; i < 6; ++i) {
      residuals[i] = T(0);
      for (int k = 0; k < 6; ++k) residuals[i] += root(i, k) * off[k];
    }
    return true;
  }
};

struct ScalarPrior {
  double value = 0, sigma = 1;  // of the unknown at zero

  template <typename T>
  bool operator()(const T* x, T* residuals) const {
    residuals[0] = (T(value) + x[0]) / sigma;
    return true;
  }
};

// Two of a clock's places in a row.
struct ChangePrior {
  double difference = 0, sigma = 1;  // of the unknowns at zero

  template <typename T>
  bool operator()(const T* from, const T* to, T* residuals) const {
    residuals[0] = (T(difference) + to[0] - from[0]) / sigma;
    return true;
  }
};

/// The problem about a state: unknowns are what is to be added to it.
class Problem {
 public:
  Problem(const MotionData& data, const MotionState& state);

  bool Step(MotionState* state, double* moved_s);
  std::optional<MotionCovariance> Covariance();

 private:
  struct CameraUnknowns {
    Knot pose{};
    double offset = 0, rolling = 0;
    std::vector<double> changes;
  };

  void AddWay();
  void AddImages(std::size_t camera);
  void AddSweeps();
  void AddChangePriors(const std::vector<double>& now, std::vector<double>* changes);
  void AddPriors();
  bool SeenAt(double seconds) const;

  const MotionData& data_;
  const MotionState& state_;
  std::vector<Knot> knots_;
  std::vector<CameraUnknowns> cameras_;
  double range_ = 0;
  ceres::Problem problem_;
  std::vector<double> image_seconds_;  // all cameras', rising
  std::vector<std::vector<ceres::ResidualBlockId>> image_blocks_;
  std::vector<ceres::ResidualBlockId> sweep_blocks_;
  MotionCovariance facts_;
};

Problem::Problem(const MotionData& data, const MotionState& state)
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

void Problem::AddWay() {
  for (Knot& knot : knots_) problem_.AddParameterBlock(knot.data(), 6);
  for (std::size_t i = 0; i + 3 < knots_.size(); ++i) {
    problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<JerkCost, 6, 6, 6, 6, 6>(new JerkCost{
                                  state_.way.KnotsOf(static_cast<int>(i)), state_.way.step_s}),
                              nullptr, knots_[i].data(), knots_[i + 1].data(), knots_[i + 2].data(),
                              knots_[i + 3].data());
  }
}

void Problem::AddImages(std::size_t index) {
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
    cost->quadratic = LineariseImage(data.camera, data_.target, image, data.sigma_px,
                                     cost->predicted, cost->predicted_by_row);
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
bool Problem::SeenAt(double seconds) const {
  const auto after = std::lower_bound(image_seconds_.begin(), image_seconds_.end(), seconds);
  if (after == image_seconds_.begin() || after == image_seconds_.end()) return false;
  return *after - *(after - 1) < data_.most_gap_s;
}

void Problem::AddSweeps() {
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

void Problem::AddChangePriors(const std::vector<double>& now, std::vector<double>* changes) {
  problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<ScalarPrior, 1, 1>(
                                new ScalarPrior{now[0], kFirstChangeSigma}),
                            nullptr, changes->data());
  for (std::size_t k = 0; k + 1 < now.size(); ++k) {
    problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<ChangePrior, 1, 1, 1>(
                                  new ChangePrior{now[k + 1] - now[k], kChangeSigma}),
                              nullptr, &(*changes)[k], &(*changes)[k + 1]);
  }
}

void Problem::AddPriors() {
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

bool Problem::Step(MotionState* state, double* moved_s) {
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

std::optional<MotionCovariance> Problem::Covariance() {
  using Sparse = Eigen::SparseMatrix<double>;
  // In this order: the knots, then all that is asked for.
  std::vector<double*> blocks;
  Eigen::Index columns = 0;
  std::map<const double*, Eigen::Index> column_of;
  const auto add = [&](double* block, Eigen::Index size) {
    if (problem_.IsParameterBlockConstant(block)) return;
    blocks.push_back(block);
    column_of[block] = columns;
    columns += size;
  };
  for (Knot& knot : knots_) add(knot.data(), 6);
  const Eigen::Index first_global = columns;
  for (CameraUnknowns& camera : cameras_) {
    add(camera.pose.data(), 6);
    add(&camera.offset, 1);
    add(&camera.rolling, 1);
    for (double& change : camera.changes) add(&change, 1);
  }
  add(&range_, 1);

  const auto jacobian_of = [&](const std::vector<ceres::ResidualBlockId>& residual_blocks,
                               double* cost) {
    ceres::Problem::EvaluateOptions options;
    options.parameter_blocks = blocks;
    options.residual_blocks = residual_blocks;
    std::vector<double> residuals;
    ceres::CRSMatrix crs;
    problem_.Evaluate(options, cost, &residuals, nullptr, &crs);
    Eigen::SparseMatrix<double, Eigen::RowMajor> rows(crs.num_rows, crs.num_cols);
    std::vector<Eigen::Triplet<double>> triplets;
    triplets.reserve(crs.values.size());
    for (int row = 0; row < crs.num_rows; ++row) {
      const auto begin = static_cast<std::size_t>(crs.rows[static_cast<std::size_t>(row)]);
      const auto end = static_cast<std::size_t>(crs.rows[static_cast<std::size_t>(row) + 1]);
      for (std::size_t k = begin; k < end; ++k) {
        if (crs.values[k] != 0) triplets.emplace_back(row, crs.cols[k], crs.values[k]);
      }
    }
    rows.setFromTriplets(triplets.begin(), triplets.end());
    return Sparse(rows);
  };
  const Sparse jacobian = jacobian_of({}, nullptr);
  const Sparse hessian = jacobian.transpose() * jacobian;
  const Eigen::SimplicialLDLT<Sparse> factor(hessian);
  if (factor.info() != Eigen::Success || !(factor.vectorD().array() > 0).all()) {
    return std::nullopt;
  }
  const Eigen::Index globals = columns - first_global;
  Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(columns, globals);
  unit.bottomRows(globals).setIdentity();
  const Eigen::MatrixXd covariance = factor.solve(unit).bottomRows(globals);

  const auto entry = [&](const double* block) -> std::optional<Eigen::Index> {
    const auto found = column_of.find(block);
    if (found == column_of.end()) return std::nullopt;
    return found->second - first_global;
  };
  for (CameraUnknowns& camera : cameras_) {
    std::vector<std::optional<Eigen::Index>> places{entry(&camera.offset), entry(&camera.rolling)};
    for (Eigen::Index i = 0; i < 6; ++i) {
      const auto pose = entry(camera.pose.data());
      places.push_back(pose ? std::optional<Eigen::Index>(*pose + i) : std::nullopt);
    }
    Eigen::Matrix<double, 8, 8> own = Eigen::Matrix<double, 8, 8>::Zero();
    for (int i = 0; i < 8; ++i) {
      for (int k = 0; k < 8; ++k) {
        const auto& a = places[static_cast<std::size_t>(i)];
        const auto& b = places[static_cast<std::size_t>(k)];
        if (a && b) own(i, k) = covariance(*a, *b);
      }
    }
    facts_.cameras.push_back(own);
    Eigen::MatrixXd changes;
    if (data_.clocks_change) {
      const auto first = entry(camera.changes.data());
      const auto count = static_cast<Eigen::Index>(camera.changes.size());
      changes = covariance.block(*first, *first, count, count);
    }
    facts_.changes.push_back(changes);
  }
  if (const auto range = entry(&range_)) facts_.range_offset_m2 = covariance(*range, *range);

  // Of each sensor's residuals, how many the unknowns took up: the trace of J H^-1 J^T.
  const auto leverage = [&](const Sparse& own) {
    double sum = 0;
    const Sparse transposed = own.transpose();
    constexpr Eigen::Index kBatch = 256;
    for (Eigen::Index first = 0; first < own.rows(); first += kBatch) {
      const Eigen::Index count = std::min(kBatch, own.rows() - first);
      const Eigen::MatrixXd some = transposed.middleCols(first, count);
      sum += some.cwiseProduct(factor.solve(some)).sum();
    }
    return sum;
  };
  const auto finish = [&](const std::vector<ceres::ResidualBlockId>& own, Misfit* misfit) {
    double cost = 0;
    if (own.empty()) return;
    const Sparse rows = jacobian_of(own, &cost);
    misfit->chi2 = 2 * cost;
    misfit->freedom -= leverage(rows);
  };
  for (std::size_t c = 0; c < cameras_.size(); ++c) {
    finish(image_blocks_[c], &facts_.camera_misfits[c]);
  }
  finish(sweep_blocks_, &facts_.sweep_misfit);
  return facts_;
}

}  // namespace

double MotionState::ByClock(std::size_t camera, const PosedImage& image) const {
  const CameraState& state = cameras[camera];
  return ToSeconds(image.utime - way.start) + state.offset_s + state.rolling_s * image.middle_row;
}

double MotionState::SecondsOf(std::size_t camera, const PosedImage& image,
                              double clock_step_s) const {
  const CameraState& state = cameras[camera];
  const double by_clock = ByClock(camera, image);
  if (state.changes_s.empty()) return by_clock;
  const auto [place, share] = ClockPlace(by_clock, clock_step_s, state.changes_s.size());
  return by_clock + Interpolated(state.changes_s, place, share);
}

Trajectory FirstWay(const std::vector<PosedImage>& images, const CameraState& camera, Utime start,
                    double step_s, double to) {
  Trajectory way{start, step_s, {}};
  const Rigid3 lidar_from_camera = camera.camera_from_lidar.Inverse();
  const auto count = static_cast<int>(std::ceil(to / step_s)) + 4;
  std::size_t next = 0;
  for (int i = 0; i < count; ++i) {
    const double seconds = (i - 1) * step_s - camera.offset_s;
    const auto at = [&](std::size_t k) { return ToSeconds(images[k].utime - start); };
    while (next < images.size() && at(next) <= seconds) ++next;
    const std::size_t b = std::min(next, images.size() - 1);
    const std::size_t a = b == 0 || next == images.size() ? b : b - 1;
    const double gap = at(b) - at(a);
    const double share = gap > 0 ? std::clamp((seconds - at(a)) / gap, 0.0, 1.0) : 0;
    const Rigid3& from = images[a].camera_from_target;
    const Rigid3& to_pose = images[b].camera_from_target;
    way.knots.push_back(lidar_from_camera * Rigid3{from.rotation.slerp(share, to_pose.rotation),
                                                   from.translation + share * (to_pose.translation -
                                                                               from.translation)});
  }
  return way;
}

bool SolveMotion(const MotionData& data, MotionState* state) {
  MotionData narrowing = data;
  double gate = 0.15;
  for (int round = 0; round < kMostRounds; ++round) {
    narrowing.on_board.gate_m = std::max(gate, data.on_board.gate_m);
    const bool narrow = gate <= data.on_board.gate_m;
    gate *= 0.6;
    const MotionState before = *state;
    double moved_s = 0;
    if (!Problem(narrowing, before).Step(state, &moved_s)) return false;
    if (narrow && moved_s < (data.clocks_change ? kChangesAtRest : kAtRest)) return true;
  }
  return false;
}

std::optional<MotionCovariance> CovarianceOf(const MotionData& data, const MotionState& state) {
  return Problem(data, state).Covariance();
}

}  // namespace rgbdt::sync
