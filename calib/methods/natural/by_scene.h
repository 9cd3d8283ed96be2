#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "calib/methods/natural/depth_edges.h"
#include "calib/methods/natural/scene_problem.h"
#include "calib/model/rig.h"
#include "calib/model/shot.h"

namespace rgbdt {

struct NaturalOptions {
  double rotation_sigma_rad = 0.035;  ///< of the start, about each of the camera's axes
  double translation_sigma_m = 0.06;  ///< of the start, along each
  /// Of the start's delta (rigid3.h) and its lens's numbers together, where it is known; then those
  /// two, and what the camera states of its lens, are not used.
  std::optional<PoseAndLensCovariance> start_covariance{};
  double shift_sigma_rad = 0.4e-3;  ///< of where a rim lies between its beams, of each kind
  double beam_sigma_rad = 0.6e-3;   ///< of half the beam's width
  double farther_sigma_m = 0.015;   ///< of how much farther away rims are than they seem
  SceneEdgeOptions edges;

  /// Of the start's delta.
  Matrix6d StartCovariance() const;
};

/// A calibration by the rims of whatever stands about.
struct SceneAlignment {
  SceneFit fit;
  SceneState state;
  SceneLook look;  ///< the last one: at full resolution, with what the data say of the edges
  SceneSums sums;  ///< at the result
  SceneMatrix covariance = SceneMatrix::Zero();  ///< of all unknowns
  /// By how much things differ from each other more than they state (variance), 1 or more.
  double scatter_factor = 1;
  /// Of each of the pose's six numbers' directions, in the start's sigmas: eigenvectors of what is
  /// known afterwards over what was known before, and that ratio of sigmas. Below 1: the scene
  /// tells.
  struct Direction {
    Vector6d delta;    ///< one sigma of the start (rigid3.h)
    double ratio = 1;  ///< of the sigma afterwards to that of the start
  };
  std::vector<Direction> directions;  ///< what is known least first
};

/// What a start that is about so wrong needs: pictures so coarse that its error is a few pixels.
SceneProblem MakeSceneProblem(const CameraSpec& camera, const std::vector<Shot>& shots,
                              const NaturalOptions& options = {});

/// Lays the depth edges of sweeps on the edges of images, from coarse pictures to fine ones, from a
/// start whose error is about the options' sigma and which is turned to all sides before. The start
/// and its sigma, and the lens and what is known of it, belong to the solve: directions of the pose
/// that the scene does not tell stay where they were. Not converged where too few things tell,
/// where another pose fits about as well, or where the result contradicts the start and its sigma.
SceneAlignment AlignToScene(const SceneProblem& problem, const Rigid3& start,
                            const NaturalOptions& options = {});

/// The same for a pose that is watched: from poses that are some ten pixels off at most, of which
/// one is in `near`, without looking to all sides. The one that fits best counts.
SceneAlignment AlignNear(const SceneProblem& problem, const Rigid3& start,
                         const NaturalOptions& options, const std::vector<Rigid3>& near);

/// How well a pose fits: the mean log-likelihood of the depth edges of other shots over that of
/// edges that the image shows nothing of, with the look, the beam and the lens of an alignment. Of
/// none: 0.
double SceneFitness(const SceneProblem& problem, const SceneAlignment& alignment,
                    const Rigid3& camera_from_lidar);

}  // namespace rgbdt
