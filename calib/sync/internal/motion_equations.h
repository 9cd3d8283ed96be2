#pragma once

#include <ceres/ceres.h>

#include <array>
#include <optional>
#include <vector>

#include "calib/sync/internal/motion_problem.h"

namespace rgbdt::sync {

/// The problem about a state, both of which must outlive it: unknowns are what is to be added to
/// it.
class MotionEquations {
 public:
  MotionEquations(const MotionData& data, const MotionState& state);

  /// Solves, and adds what was found to `state`. `moved_s`: by how much offsets and read-outs moved
  /// at most. False: there is no solution.
  bool Step(MotionState* state, double* moved_s);
  /// At unknowns of zero. Nothing: the normal equations are singular.
  std::optional<MotionCovariance> Covariance();

 private:
  using Knot = std::array<double, 6>;
  struct CameraUnknowns {
    Knot pose{};
    double offset = 0, rolling = 0;
    std::vector<double> changes;
  };

  void AddWay();
  void AddImages(std::size_t index);  // of a camera
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

}  // namespace rgbdt::sync
