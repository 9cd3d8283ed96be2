#pragma once

#include <optional>
#include <vector>

#include "calib/solve/board_problem.h"
#include "calib/solve/internal/joint_problem.h"
#include "calib/solve/internal/lens_check.h"
#include "calib/solve/internal/placements.h"

namespace rgbdt {

/// A range offset that was held to less than the views say (see SolveJointly): what it was held to
/// [m], 1 sigma, of a further LIDAR or of the reference. Its prior is wide then.
struct RefutedOffset {
  std::optional<std::size_t> lidar;
  double known_m = 0;
};

/// A joint solve of which views and sides that contradict the others were left out.
struct JointResult {
  JointProblem joint;  ///< what is left of it
  BoardSolution solution;
  std::optional<ViewScatter> view_scatter;  ///< absent: fewer than four views
  double variance_factor = 1;               ///< by which the covariance was enlarged (FactorFor)
  /// Of the views that are left: by `factor`, too, covariances are enlarged.
  Placements placements{};
  std::vector<double> lidar_factors{};  ///< the same of each further LIDAR's own
  /// By further LIDAR: its pose by edges alone against that by planes alone
  /// (HoldEdgesAgainstPlanes).
  std::vector<std::optional<Halves>> lidars_edges_planes{};
  std::vector<RefutedOffset> refuted_offsets{};
  /// By camera: the lens found against the given one; chi-square as it was before its prior was
  /// widened.
  std::vector<LensOff> lenses_off;
  std::optional<EncoderDelay> encoder_delay{};  ///< absent: no motor turned (encoder_delay.h)

  /// By which the solution's covariance of cameras' poses and lenses is to be multiplied.
  double PoseFactor() const { return variance_factor * placements.factor; }
};

/// Solves; leaves out what contradicts the rest, worst first, at most a third of a camera's views,
/// and solves again. What is left out is gone from the problem, and rejected with its reason among
/// the cameras' views. A view's own estimate of a camera against that of all others: beyond
/// what chance does once in 20,000 views, it is out. A side's own shift beyond 4 of its sigmas: its
/// crossings are out, and a warning says so. Where the views put a range offset beyond 4 sigma
/// of what its prior allows, all is solved again with it free (the reference's not by a plain
/// board); where they contradict what is known of a lens, with that known as much worse as they
/// say; where they scatter far beyond noise, lenses that are stated as exact and that the images
/// alone contradict are as uncertain as any.
JointResult SolveJointly(JointProblem joint);

/// How far two solutions put a camera, or a further LIDAR, apart, against both covariances, a
/// factor of variance counted in.
Halves Apart(const BoardSolution& a, const BoardSolution& b, double variance_factor,
             std::size_t camera);
Halves LidarApart(const BoardSolution& a, const BoardSolution& b, const JointResult& result,
                  std::size_t lidar);

/// The result as it is without further LIDARs.
[[nodiscard]] JointResult WithoutLidars(JointResult result);

/// Of camera `index`, the variance factor and the places counted in, and what is not known of the
/// encoder's delay.
PoseAndLensCovariance CovarianceOf(const JointResult& result, std::size_t index);

}  // namespace rgbdt
