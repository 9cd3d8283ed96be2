#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "calib/methods/natural/depth_edges.h"
#include "calib/methods/natural/image_rims.h"
#include "calib/methods/natural/known_rims.h"
#include "calib/model/lens.h"
#include "calib/model/rig.h"
#include "calib/model/rigid3.h"
#include "calib/model/shot.h"

namespace rgbdt {

/// What is solved for: delta (rigid3.h); for each kind of edge, by how much the rim lies
/// farther out than halfway between its beams [rad]; half the beam's width [rad], which SceneEdge
/// counts its reach in; by how much rims are farther away than they seem [m]; and the lens's
/// numbers (lens.h).
inline constexpr int kShiftAt = 6, kBeamAt = kShiftAt + kSceneEdgeKinds, kFartherAt = kBeamAt + 1,
                     kLensAt = kFartherAt + 1;
inline constexpr int kSceneUnknowns = kLensAt + kLensNumbers;
using SceneVector = Eigen::Matrix<double, kSceneUnknowns, 1>;
using SceneMatrix = Eigen::Matrix<double, kSceneUnknowns, kSceneUnknowns>;

struct SceneState {
  Rigid3 camera_from_lidar;
  std::array<double, kSceneEdgeKinds> shift_rad{};
  double beam_rad = 1.2e-3;
  /// A round thing recedes towards its rim as the square root of the distance from it, which its
  /// last beams do not tell: a trunk of 0.3 m at 6 m, beams 0.25 deg apart, by 40 mm more; a flat
  /// thing by none. It makes the distance from LIDAR to camera too small, by 0.5% where it is left
  /// out.
  double farther_m = 0.01;
  Lens lens;

  SceneState Moved(const SceneVector& x) const;
};

/// How the image is looked at in one round.
struct SceneLook {
  int level = 0;  ///< of the pictures
  /// Of a thing's shift beside its kind's, and of a single rim's beside its thing's: which of two
  /// surfaces a beam returns that meets both depends on how bright they are.
  double thing_sigma_rad = 0.4e-3, rim_sigma_rad = 0.4e-3;
  std::size_t stride = 1;  ///< every how manieth edge is looked at
  double sigma_px = 1;     ///< of an image edge about the rim it belongs to [px of the level]
  int reach_px = 8;        ///< how far edges are looked for [px of the level]
  /// Information as it is observed: less where it is not known which edge belongs to a rim. For
  /// covariances; steps take the expected one, which is positive.
  bool observed = false;
  /// By source: share of the rims that the image shows as an edge.
  std::array<double, kEdgeSources> matched{0.5, 0.5};
  bool reflectivity = true;  ///< edges of reflectivity are looked at
};

/// Edges of a cloud that lie in the image, and how many of these it shows, in expectation.
struct ShownEdges {
  double edges = 0, matched = 0;
  double Share() const { return edges > 0 ? matched / edges : 0; }
};

/// The normal equations of one round, the shifts of things and rims eliminated, and what the round
/// tells of the data.
struct SceneSums {
  SceneMatrix information = SceneMatrix::Zero();  ///< of the unknowns
  SceneVector gradient = SceneVector::Zero();     ///< information * step = gradient
  double log_likelihood = 0;  ///< over that of edges which the image shows nothing of
  std::array<ShownEdges, kEdgeSources> shown{};  ///< by source (SourceOf)
  std::array<double, kImageParts> where{};       ///< of those that are shown, by part of the image
  double squares = 0;  ///< of their residuals, less what beams' spacing makes [px^2 of the level]
  /// By thing: its part of information and gradient.
  std::vector<std::pair<SceneMatrix, SceneVector>> parts;
  double things = 0;  ///< that tell, in expectation

  const ShownEdges& Depth() const { return shown[0]; }
  ShownEdges All() const {
    return {shown[0].edges + shown[1].edges, shown[0].matched + shown[1].matched};
  }
};

/// What of a shot does not depend on the pose: the cloud's edges and the image's, by level.
struct SceneShot {
  ShotPlace place;
  std::vector<SceneEdge> edges;
  std::vector<ImageRims> pictures;
};

struct SceneEdgeOptions {
  DepthEdgeOptions depth;
  bool reflectivity = true;       ///< of colour cameras: paint is not warmer than what is beside it
  std::size_t most_edges = 8000;  ///< of each source, in a sweep
};

/// Edges are found in the cloud. There are `levels` pictures, or as many as have sixteen pixels at
/// least each way.
std::shared_ptr<const SceneShot> PrepareShot(const CameraSpec& camera, const Shot& shot,
                                             const SceneEdgeOptions& edges, int levels);

/// Rims of sweeps and the images that they are laid on. A rim of the cloud is met by one of the
/// image's edges nearby, or by none: a mixture of normal distributions about each of them and of
/// an even one. (Levinson and Thrun 2013 and Krishnan et al. 2015 let every rim count for the edges
/// about it; with the mixture a residual has a sigma, and what is not shown does not pull.)
class SceneProblem {
 public:
  /// Of shots that were made ready with the same number of levels.
  SceneProblem(const CameraSpec& camera,
               const std::vector<std::shared_ptr<const SceneShot>>& shots);
  /// Of shots as they come (PrepareShot).
  SceneProblem(const CameraSpec& camera, const std::vector<Shot>& shots,
               const SceneEdgeOptions& edges, int levels);

  const CameraSpec& spec() const { return spec_; }
  int levels() const { return levels_; }
  std::size_t edges() const;
  SceneSums SumsAt(const SceneState& state, const SceneLook& look) const;

 private:
  struct Part {
    std::shared_ptr<const SceneShot> shot;
    std::vector<int> rims;  // by edge: the same number for the same rim, in all shots
  };

  CameraSpec spec_;
  int levels_ = 1;
  std::vector<Part> parts_;
  std::vector<SceneRim> rims_;
};

}  // namespace rgbdt
