#pragma once

#include <ceres/cost_function.h>

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/methods/paper/internal/extrapolated_projection.h"
#include "calib/model/rigid3.h"
#include "calib/solve/distance_field.h"

namespace rgbdt {

/// The paper's objective for one view (equation 1): residual i is the distance field's value where
/// boundary point i projects, one residual a point,
///
///   r_i(delta) = D(project(Exp(delta) * start * point_i)),
///
/// delta the 6 parameters (rx, ry, rz [rad], tx, ty, tz [m], camera axes) about the start. A point
/// outside the image takes the border pixel's value, one that no lens could see (behind the camera)
/// half the image's width; with a field that goes on smoothly, each takes what the field says where
/// ExtrapolatedProjection puts it. Derivatives by central differences of 1e-6 (paper II-A.3).
class PaperCost : public ceres::CostFunction {
 public:
  static constexpr double kDelta = 1e-6;

  /// `camera`, `field` and `points` [m, LIDAR frame] outlive the cost.
  static std::unique_ptr<ceres::CostFunction> Create(const Camera* camera,
                                                     const DistanceField* field,
                                                     const std::vector<Eigen::Vector3d>* points,
                                                     const Rigid3& start) {
    return std::make_unique<PaperCost>(camera, field, points, start);
  }

  PaperCost(const Camera* camera, const DistanceField* field,
            const std::vector<Eigen::Vector3d>* points, const Rigid3& start);

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  void Residuals(const Vector6d& delta, double* residuals) const;
  double Residual(const Eigen::Vector3d& point_in_camera) const;

  const Camera* camera_;
  const DistanceField* field_;
  const std::vector<Eigen::Vector3d>* points_;
  Rigid3 start_;
  std::optional<ExtrapolatedProjection> extrapolated_;  // with a smooth field only
};

/// The residual of one point with the paper's own field: see PaperCost.
double PaperResidual(const Camera& camera, const DistanceField& field,
                     const Eigen::Vector3d& point_in_camera);

}  // namespace rgbdt
