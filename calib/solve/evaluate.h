#pragma once

#include <array>
#include <optional>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"
#include "calib/solve/board_problem.h"
#include "calib/solve/camera_views.h"

namespace rgbdt {

/// Distance of a pixel from a closed chain of pixels, a board's outline; 1e300 without one.
double DistanceToOutline(const Eigen::Vector2d& pixel, const std::vector<Eigen::Vector2d>& outline);

/// How well a calibration lays a view's boundary points on the image. The view must be usable.
/// distance_transform_px: mean of the distance transform at the projected points (the paper's
/// reprojection error). edge_rms_px: RMS distance to the fitted outline. A point that the lens
/// cannot see counts half the image's width.
ViewQuality JudgeView(const CameraSpec& camera, const CameraView& view,
                      const Rigid3& camera_from_lidar);

/// What the distances of a board's crossings from its sides, and of its points from its plane, are
/// held against.
struct EdgeModel {
  Target target;
  /// By the solve; without one, as they are likeliest beforehand.
  std::array<double, kSharedUnknowns> shared = BoardPriors().Means();
  BoardPriors priors{};
  RangeTerms ranges{};
  std::vector<double> range_terms{};  ///< by term of `ranges` [m]
};

/// A board's crossings and points against its sides and its plane, laid there by one camera's image
/// and its calibration. Sums over crossings, and over points.
struct EdgeMisfit {
  double squared = 0;     ///< of the crossings' squared distances, each in its sigmas
  double squared_m2 = 0;  ///< the same in metres on the board
  double count = 0;
  double plane_squared_m2 = 0;  ///< of the points' squared distances
  double points = 0;

  void Add(const EdgeMisfit& other);
  std::optional<double> RmsWhitened() const;
  std::optional<double> RmsMm() const;
  std::optional<double> PlaneRmsMm() const;
};

/// Each crossing's distance from its side, where the image's pose and `calibration` put it, also
/// over its sigma: of the crossing's interval, the side's own shift, the image's pose and the
/// calibration (where it has a covariance). Zero crossings where the view has none with sigmas.
EdgeMisfit MisfitOfEdges(const EdgeModel& model, const CameraView& view,
                         const CameraCalibration& calibration);

/// A camera's report with `views`, `distance_transform_px` and `edge_rms_px` by its calibration:
/// means over all points of the views used, and of those held out.
[[nodiscard]] CameraReport JudgeCamera(const CameraSpec& spec,
                                       const std::vector<const CameraView*>& usable,
                                       CameraReport report);

/// A report that JudgeCamera has made, with `edge_rms_whitened`, `edge_rms_mm` and `plane_rms_mm`
/// of the camera and of its views.
[[nodiscard]] CameraReport JudgeEdges(const EdgeModel& model,
                                      const std::vector<const CameraView*>& usable,
                                      CameraReport report);

}  // namespace rgbdt
