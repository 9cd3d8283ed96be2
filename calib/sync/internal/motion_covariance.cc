#include <Eigen/SparseCholesky>
#include <map>

#include "calib/sync/internal/motion_equations.h"

namespace rgbdt::sync {

std::optional<MotionCovariance> MotionEquations::Covariance() {
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

}  // namespace rgbdt::sync
