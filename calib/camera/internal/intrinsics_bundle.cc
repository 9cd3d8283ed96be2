#include "calib/camera/internal/intrinsics_bundle.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <Eigen/Dense>
#include <algorithm>
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
//   r = project(lens; R(pose) * point + t(pose)) - pixel.
template <int kParameters>
struct CornerError {
  Lens::Model model;
  Eigen::Vector3d point;
  Eigen::Vector2d pixel;

  template <typename T>
  bool operator()(const T* lens, const T* pose, T* residual) const {
    T k[8] = {T(0), T(0), T(0), T(0), T(0), T(0), T(0), T(0)};
    std::copy(lens + 4, lens + kParameters, k);
    const T in_target[3] = {T(point.x()), T(point.y()), T(point.z())};
    T p[3];
    ceres::AngleAxisRotatePoint(pose, in_target, p);
    for (int i = 0; i < 3; ++i) p[i] += pose[3 + i];
    if (model == Lens::Model::kPinhole && !(p[2] > T(1e-6))) return false;
    ProjectUnchecked(model, lens, lens + 2, k, p[0], p[1], p[2], &residual[0], &residual[1]);
    residual[0] -= pixel.x();
    residual[1] -= pixel.y();
    return true;
  }

  static std::unique_ptr<ceres::CostFunction> Create(Lens::Model model,
                                                     const Eigen::Vector3d& point,
                                                     const Eigen::Vector2d& pixel) {
    return std::make_unique<ceres::AutoDiffCostFunction<CornerError, 2, kParameters, 6>>(
        new CornerError{model, point, pixel});
  }
};

std::unique_ptr<ceres::CostFunction> MakeError(LensChoice choice, const Eigen::Vector3d& point,
                                               const Eigen::Vector2d& pixel) {
  switch (choice) {
    case LensChoice::kPinhole8:
      return CornerError<12>::Create(ModelOf(choice), point, pixel);
    case LensChoice::kFisheye:
      return CornerError<8>::Create(ModelOf(choice), point, pixel);
    case LensChoice::kPinhole5:
      break;
  }
  return CornerError<9>::Create(ModelOf(choice), point, pixel);
}

void Hold(int from, std::vector<double>* lens, ceres::Problem* problem) {
  const int all = static_cast<int>(lens->size());
  if (from >= all) return;
  std::vector<int> held(static_cast<std::size_t>(all - from));
  std::iota(held.begin(), held.end(), from);
  problem->SetManifold(lens->data(), new ceres::SubsetManifold(all, held));
}

void AddView(const Bundle& bundle, double loss_scale, double* lens, BundleView* view,
             ceres::Problem* problem) {
  for (std::size_t i = 0; i < view->pixels.size(); ++i) {
    if (!view->used[i]) continue;
    ceres::LossFunction* loss = loss_scale > 0 ? new ceres::CauchyLoss(loss_scale) : nullptr;
    problem->AddResidualBlock(MakeError(bundle.choice, bundle.points[i], view->pixels[i]).release(),
                              loss, lens, view->pose.data());
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

// One view's derivatives by the lens, with whatever a change of its pose can undo projected out:
// rows of what is left (QR: no squaring of the condition number). Also sums the residuals' squares.
Eigen::MatrixXd ReducedJacobian(const Bundle& bundle, const BundleView& view, double* squares) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto used = std::count(view.used.begin(), view.used.end(), true);
  const auto parameters = static_cast<Eigen::Index>(bundle.lens.size());
  Eigen::MatrixXd by_lens(2 * used, parameters);
  Eigen::MatrixXd by_pose(2 * used, 6);
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < view.used.size(); ++i) {
    if (!view.used[i]) continue;
    const auto error = MakeError(bundle.choice, bundle.points[i], view.pixels[i]);
    const double* blocks[2] = {bundle.lens.data(), view.pose.data()};
    Eigen::Vector2d residual(0, 0);
    RowMajor lens_block = RowMajor::Zero(2, parameters);
    RowMajor pose_block = RowMajor::Zero(2, 6);
    double* jacobians[2] = {lens_block.data(), pose_block.data()};
    error->Evaluate(blocks, residual.data(), jacobians);
    by_lens.middleRows<2>(row) = lens_block;
    by_pose.middleRows<2>(row) = pose_block;
    *squares += residual.squaredNorm();
    row += 2;
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(by_pose);
  by_lens.applyOnTheLeft(qr.householderQ().adjoint());
  return by_lens.bottomRows(2 * used - 6);
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
  for (BundleView& view : bundle->views) {
    if (!view.active) continue;
    AddView(*bundle, options.loss_scale, lens, &view, &problem);
    ordering->AddElementToGroup(view.pose.data(), 0);
  }
  ordering->AddElementToGroup(lens, 1);
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
  ceres::Problem problem;
  AddView(bundle, loss_scale, lens.data(), view, &problem);
  problem.SetParameterBlockConstant(lens.data());
  ceres::Solver::Options solver = SolverOptions(100);
  solver.linear_solver_type = ceres::DENSE_QR;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
}

std::vector<Eigen::Vector2d> Residuals(const Bundle& bundle, const BundleView& view) {
  std::vector<Eigen::Vector2d> residuals;
  const double* blocks[2] = {bundle.lens.data(), view.pose.data()};
  for (std::size_t i = 0; i < view.pixels.size(); ++i) {
    Eigen::Vector2d residual(0, 0);
    const auto error = MakeError(bundle.choice, bundle.points[i], view.pixels[i]);
    if (!error->Evaluate(blocks, residual.data(), nullptr)) residual.setConstant(-kBehind);
    residuals.emplace_back(-residual);
  }
  return residuals;
}

Eigen::MatrixXd LensCovariance(const Bundle& bundle) {
  std::vector<Eigen::MatrixXd> parts;
  double squares = 0;
  Eigen::Index rows = 0;
  for (const BundleView& view : bundle.views) {
    if (!view.active) continue;
    parts.push_back(ReducedJacobian(bundle, view, &squares));
    rows += parts.back().rows();
  }
  const auto parameters = static_cast<Eigen::Index>(bundle.lens.size());
  if (rows <= parameters) return {};
  Eigen::MatrixXd jacobian(rows, parameters);
  Eigen::Index row = 0;
  for (const Eigen::MatrixXd& part : parts) {
    jacobian.middleRows(row, part.rows()) = part;
    row += part.rows();
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
  const double variance = squares / static_cast<double>(rows - parameters);
  return variance * rooted * rooted.transpose();
}

}  // namespace rgbdt
