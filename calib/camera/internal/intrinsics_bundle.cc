#include "calib/camera/internal/intrinsics_bundle.h"

#include <ceres/cost_function.h>
#include <ceres/jet.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/rotation.h>
#include <ceres/sized_cost_function.h>
#include <ceres/solver.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>

#include "calib/camera/lens.h"

namespace rgbdt {
namespace {

constexpr double kBehind = 1e6;  // [px]: as far off as can be, but a number

Lens::Model ModelOf(LensChoice choice) {
  return choice == LensChoice::kFisheye ? Lens::Model::kFisheye : Lens::Model::kPinhole;
}

// predicted - measured [px] of one corner:
//   r = project(lens; R(pose) * formed(board; point) + t(pose)) - pixel.
// All choices of a lens by the derivatives of the largest: what one lacks is zero.
class CornerError : public ceres::CostFunction {
 public:
  CornerError(LensChoice choice, int parameters, const Eigen::Vector3d& point,
              const Eigen::Vector3d& bow_factors, const Eigen::Vector2d& pixel)
      : model_(ModelOf(choice)),
        parameters_(parameters),
        point_(point),
        bow_factors_(bow_factors),
        pixel_(pixel) {
    set_num_residuals(2);
    mutable_parameter_block_sizes()->assign({parameters, kPose, kBoardUnknowns});
  }

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const override {
    using Jet = ceres::Jet<double, kLens + kPose + kBoardUnknowns>;
    std::array<Jet, kLens> lens;
    std::array<Jet, kPose> pose;
    for (int i = 0; i < parameters_; ++i) lens[i] = Jet(blocks[0][i], i);
    for (int i = 0; i < kPose; ++i) pose[i] = Jet(blocks[1][i], kLens + i);
    // Half of it each way, about the origin: what else it moves is the pose's.
    const Jet half = Jet(blocks[2][kAspect], kLens + kPose + kAspect) / 2.0;
    Jet z(point_.z());
    for (int i = 0; i < 3; ++i) {
      z += Jet(blocks[2][kBow + i], kLens + kPose + kBow + i) * bow_factors_[i];
    }
    const std::array<Jet, 3> in_target = {point_.x() * (1.0 - half), point_.y() * (1.0 + half), z};
    std::array<Jet, 3> p;
    ceres::AngleAxisRotatePoint(pose.data(), in_target.data(), p.data());
    for (int i = 0; i < 3; ++i) p[i] += pose[3 + i];
    if (model_ == Lens::Model::kPinhole && !(p[2].a > 1e-6)) return false;
    std::array<Jet, 2> pixel;
    const Jet* const f = lens.data();
    ProjectUnchecked(model_, f, f + 2, f + 4, p[0], p[1], p[2], &pixel[0], &pixel[1]);
    for (int row = 0; row < 2; ++row) {
      residual[row] = pixel[row].a - pixel_[row];
      if (jacobians == nullptr) continue;
      const double* const by = pixel[row].v.data();
      if (jacobians[0]) std::copy_n(by, parameters_, jacobians[0] + row * parameters_);
      if (jacobians[1]) std::copy_n(by + kLens, kPose, jacobians[1] + row * kPose);
      if (jacobians[2]) {
        std::copy_n(by + kLens + kPose, kBoardUnknowns, jacobians[2] + row * kBoardUnknowns);
      }
    }
    return true;
  }

 private:
  static constexpr int kLens = 12, kPose = 6;
  Lens::Model model_;
  int parameters_;
  Eigen::Vector3d point_, bow_factors_;
  Eigen::Vector2d pixel_;
};

// What is known of the board, as strong as the corners where these scatter as most do.
class BoardPrior : public ceres::SizedCostFunction<kBoardUnknowns, kBoardUnknowns> {
 public:
  explicit BoardPrior(const BoardNumbers& sigmas) : sigmas_(sigmas) {}

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const override {
    constexpr double kUsualCornerPx = 0.1;
    const bool derive = jacobians != nullptr && jacobians[0] != nullptr;
    if (derive) std::fill_n(jacobians[0], kBoardUnknowns * kBoardUnknowns, 0.0);
    for (std::size_t i = 0; i < kBoardUnknowns; ++i) {
      const double weight = kUsualCornerPx / sigmas_[i];
      residual[i] = weight * blocks[0][i];
      if (derive) jacobians[0][i * kBoardUnknowns + i] = weight;
    }
    return true;
  }

 private:
  BoardNumbers sigmas_;
};

CornerError ErrorOf(const Bundle& bundle, const BundleView& view, std::size_t corner) {
  return {bundle.choice, static_cast<int>(bundle.lens.size()), bundle.points[corner],
          bundle.bow_factors[corner], view.pixels[corner]};
}

void Hold(int from, std::vector<double>* lens, ceres::Problem* problem) {
  const int all = static_cast<int>(lens->size());
  if (from >= all) return;
  std::vector<int> held(static_cast<std::size_t>(all - from));
  std::iota(held.begin(), held.end(), from);
  problem->SetManifold(lens->data(), new ceres::SubsetManifold(all, held));
}

// The blocks that all views share.
struct SharedBlocks {
  double* lens;
  double* board;
};

void AddView(const Bundle& bundle, double loss_scale, const SharedBlocks& shared, BundleView* view,
             ceres::Problem* problem) {
  for (std::size_t i = 0; i < view->pixels.size(); ++i) {
    if (!view->used[i]) continue;
    ceres::LossFunction* loss = loss_scale > 0 ? new ceres::CauchyLoss(loss_scale) : nullptr;
    problem->AddResidualBlock(new CornerError(ErrorOf(bundle, *view, i)), loss, shared.lens,
                              view->pose.data(), shared.board);
  }
}

ceres::Solver::Options SolverOptions(int max_iterations) {
  ceres::Solver::Options solver;
  solver.num_threads = 1;  // the same bits every time
  solver.max_num_iterations = max_iterations;
  solver.function_tolerance = 1e-10;
  solver.parameter_tolerance = 1e-10;
  solver.gradient_tolerance = 1e-12;
  // Damping never vanishes: Cholesky then works on what the views do not determine, too.
  solver.max_trust_region_radius = 1e10;
  solver.logging_type = ceres::SILENT;
  return solver;
}

// One view's derivatives by the lens and the board, with whatever a change of its pose can
// undo projected out: rows of what is left (QR: no squaring of the condition number). Also sums the
// residuals' squares.
Eigen::MatrixXd ReducedJacobian(const Bundle& bundle, const BundleView& view, double* squares) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto used = std::count(view.used.begin(), view.used.end(), true);
  const auto parameters = static_cast<Eigen::Index>(bundle.lens.size());
  Eigen::MatrixXd by_shared(2 * used, parameters + kBoardUnknowns);
  Eigen::MatrixXd by_pose(2 * used, 6);
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < view.used.size(); ++i) {
    if (!view.used[i]) continue;
    const CornerError error = ErrorOf(bundle, view, i);
    const double* blocks[3] = {bundle.lens.data(), view.pose.data(), bundle.board.data()};
    Eigen::Vector2d residual(0, 0);
    RowMajor lens_block = RowMajor::Zero(2, parameters);
    RowMajor pose_block = RowMajor::Zero(2, 6);
    RowMajor board_block = RowMajor::Zero(2, kBoardUnknowns);
    double* jacobians[3] = {lens_block.data(), pose_block.data(), board_block.data()};
    error.Evaluate(blocks, residual.data(), jacobians);
    by_shared.middleRows<2>(row) << lens_block, board_block;
    by_pose.middleRows<2>(row) = pose_block;
    *squares += residual.squaredNorm();
    row += 2;
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(by_pose);
  by_shared.applyOnTheLeft(qr.householderQ().adjoint());
  return by_shared.bottomRows(2 * used - 6);
}

}  // namespace

std::vector<std::string> ParameterNames(LensChoice choice) {
  switch (choice) {
    case LensChoice::kPinhole8:
      return {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
    case LensChoice::kFisheye:
      return {"fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4"};
    case LensChoice::kPinhole5:
      break;
  }
  return {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"};
}

std::vector<double> ParametersOf(const Lens& lens, LensChoice choice) {
  std::vector<double> parameters = {lens.fx, lens.fy, lens.cx, lens.cy};
  parameters.insert(parameters.end(), lens.distortion.begin(), lens.distortion.end());
  parameters.resize(ParameterNames(choice).size());
  return parameters;
}

Lens LensOf(const std::vector<double>& parameters, LensChoice choice) {
  Lens lens;
  lens.model = ModelOf(choice);
  lens.fx = parameters[0];
  lens.fy = parameters[1];
  lens.cx = parameters[2];
  lens.cy = parameters[3];
  std::copy(parameters.begin() + 4, parameters.end(), lens.distortion.begin());
  return lens;
}

bool Solve(const BundleSolve& options, Bundle* bundle, std::string* why) {
  ceres::Problem problem;
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  double* const lens = bundle->lens.data();
  double* const board = bundle->board.data();
  for (BundleView& view : bundle->views) {
    if (!view.active) continue;
    AddView(*bundle, options.loss_scale, {lens, board}, &view, &problem);
    ordering->AddElementToGroup(view.pose.data(), 0);
  }
  ordering->AddElementToGroup(lens, 1);
  ordering->AddElementToGroup(board, 1);
  if (bundle->board_sigmas) {
    problem.AddResidualBlock(new BoardPrior(*bundle->board_sigmas), nullptr, board);
  } else {
    problem.SetParameterBlockConstant(board);
  }
  Hold(options.parameters, &bundle->lens, &problem);
  for (int i = 0; i < 2; ++i) {  // views that determine no focal length would let it run off
    problem.SetParameterLowerBound(lens, i, bundle->least_focal);
    problem.SetParameterUpperBound(lens, i, bundle->greatest_focal);
  }
  ceres::Solver::Options solver = SolverOptions(options.max_iterations);
  solver.linear_solver_type = ceres::DENSE_SCHUR;
  solver.linear_solver_ordering = ordering;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  if (summary.termination_type == ceres::CONVERGENCE) return true;
  *why = "the solver stopped: " + summary.message;
  return false;
}

void SolvePose(double loss_scale, const Bundle& bundle, BundleView* view) {
  view->used.assign(view->used.size(), true);
  for (const Eigen::Vector2d& residual : Residuals(bundle, *view)) {
    if (residual.x() == kBehind) return;  // Ceres could not even begin
  }
  std::vector<double> lens = bundle.lens;
  BoardNumbers board = bundle.board;
  ceres::Problem problem;
  AddView(bundle, loss_scale, {lens.data(), board.data()}, view, &problem);
  problem.SetParameterBlockConstant(lens.data());
  problem.SetParameterBlockConstant(board.data());
  ceres::Solver::Options solver = SolverOptions(100);
  solver.linear_solver_type = ceres::DENSE_QR;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
}

std::vector<Eigen::Vector2d> Residuals(const Bundle& bundle, const BundleView& view) {
  std::vector<Eigen::Vector2d> residuals;
  const double* blocks[3] = {bundle.lens.data(), view.pose.data(), bundle.board.data()};
  for (std::size_t i = 0; i < view.pixels.size(); ++i) {
    Eigen::Vector2d residual(0, 0);
    const CornerError error = ErrorOf(bundle, view, i);
    if (!error.Evaluate(blocks, residual.data(), nullptr)) residual.setConstant(-kBehind);
    residuals.emplace_back(-residual);
  }
  return residuals;
}

Eigen::MatrixXd CovarianceOfLensAndBoard(const Bundle& bundle) {
  std::vector<Eigen::MatrixXd> parts;
  double squares = 0;
  Eigen::Index rows = 0;
  for (const BundleView& view : bundle.views) {
    if (!view.active) continue;
    parts.push_back(ReducedJacobian(bundle, view, &squares));
    rows += parts.back().rows();
  }
  const Eigen::Index unknown_of_board = bundle.board_sigmas ? kBoardUnknowns : 0;
  const Eigen::Index of_lens = static_cast<Eigen::Index>(bundle.lens.size());
  const Eigen::Index parameters = of_lens + unknown_of_board;
  if (rows <= parameters) return {};
  const double variance = squares / static_cast<double>(rows - parameters);
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(rows + unknown_of_board, parameters);
  Eigen::Index row = 0;
  for (const Eigen::MatrixXd& part : parts) {
    jacobian.middleRows(row, part.rows()) = part.leftCols(parameters);
    row += part.rows();
  }
  for (Eigen::Index i = 0; i < unknown_of_board; ++i) {
    jacobian(rows + i, of_lens + i) =
        std::sqrt(variance) / (*bundle.board_sigmas)[static_cast<std::size_t>(i)];
  }
  if (!jacobian.allFinite()) return {};
  // Columns of length one: pixels and coefficients of r^8 have nothing to do with each other.
  const Eigen::VectorXd length = jacobian.colwise().norm().transpose();
  if (!(length.minCoeff() > 0)) return {};
  jacobian *= length.cwiseInverse().asDiagonal();
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(jacobian);
  if (qr.rank() < parameters) return {};
  const Eigen::MatrixXd root = qr.matrixR()
                                   .topLeftCorner(parameters, parameters)
                                   .template triangularView<Eigen::Upper>()
                                   .solve(Eigen::MatrixXd::Identity(parameters, parameters));
  const Eigen::MatrixXd rooted = length.cwiseInverse().asDiagonal() * (qr.colsPermutation() * root);
  return variance * rooted * rooted.transpose();
}

}  // namespace rgbdt
