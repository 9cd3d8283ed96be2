#include "calib/methods/paper/internal/paper_cost.h"

namespace rgbdt {

double PaperResidual(const Camera& camera, const DistanceField& field,
                     const Eigen::Vector3d& point_in_camera) {
  const auto pixel = camera.Project(point_in_camera);
  return pixel ? field.Value(*pixel) : 0.5 * field.width();
}

PaperCost::PaperCost(const Camera* camera, const DistanceField* field,
                     const std::vector<Eigen::Vector3d>* points, const Rigid3& start)
    : camera_(camera), field_(field), points_(points), start_(start) {
  set_num_residuals(static_cast<int>(points->size()));
  mutable_parameter_block_sizes()->push_back(6);
  if (field->beyond() == FieldBeyond::kSmooth) extrapolated_.emplace(camera);
}

double PaperCost::Residual(const Eigen::Vector3d& point_in_camera) const {
  return extrapolated_ ? field_->Value(extrapolated_->Project(point_in_camera))
                       : PaperResidual(*camera_, *field_, point_in_camera);
}

void PaperCost::Residuals(const Vector6d& delta, double* residuals) const {
  const Rigid3 camera_from_lidar = Exp(delta) * start_;
  const Eigen::Matrix3d rotation = camera_from_lidar.rotation.toRotationMatrix();
  for (std::size_t i = 0; i < points_->size(); ++i) {
    residuals[i] = Residual(rotation * (*points_)[i] + camera_from_lidar.translation);
  }
}

bool PaperCost::Evaluate(double const* const* parameters, double* residuals,
                         double** jacobians) const {
  const Vector6d delta = Eigen::Map<const Vector6d>(parameters[0]);
  Residuals(delta, residuals);
  if (jacobians == nullptr || jacobians[0] == nullptr) return true;
  const auto n = static_cast<Eigen::Index>(points_->size());
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>> jacobian(jacobians[0], n,
                                                                                 6);
  Eigen::VectorXd plus(n);
  Eigen::VectorXd minus(n);
  for (int axis = 0; axis < 6; ++axis) {
    const Vector6d step = kDelta * Vector6d::Unit(axis);
    Residuals(delta + step, plus.data());
    Residuals(delta - step, minus.data());
    jacobian.col(axis) = (plus - minus) / (2 * kDelta);
  }
  return true;
}

}  // namespace rgbdt
