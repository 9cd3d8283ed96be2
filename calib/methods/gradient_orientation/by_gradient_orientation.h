#pragma once

#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/methods/gradient_orientation/cloud_gradients.h"
#include "calib/methods/scene/particle_swarm.h"
#include "calib/methods/scene/pose_search.h"
#include "calib/model/rig.h"
#include "calib/model/shot.h"

namespace rgbdt {

// What the paper leaves open, and what stands here. A point's neighbours are the 8 about it in the
// LIDAR's own grid instead of the 8 nearest on the sphere, and its gradient is the least-squares
// plane through them instead of their weighted sum: rings are farther apart than beams of a ring,
// of which all of the 8 nearest would be. Image gradients are Sobel's of an image smoothed to what
// the LIDAR resolves (sigma: half of the angle between its beams), read between pixels.
// Gradients of the range are the weaker feature: the ground has them everywhere, its image not. On
// synthetic scenes they ended 1 to 3 degrees off.

struct GradientOrientationOptions {
  /// Absent: intensity where every cloud has it, or else range.
  std::optional<CloudFeature> feature;
  std::size_t most_points = 40000;  ///< of all shots, an equal part of each
  std::size_t least_points = 300;   ///< with a gradient, in all images, at the result
  SwarmOptions swarm;
  PoseSteps probe{0.017453292519943295, 0.05};  ///< for `least_worse`
  /// Share of the poses a `probe` away that have to be worse, or the result is no peak.
  double least_worse = 0.9;
};

/// The paper's measure as a function of a camera's pose. Throws InputError for images that are not
/// the camera's, and for feature kIntensity where a cloud has none.
class GradientAlignment {
 public:
  /// `near`: points are looked for about where this pose sees them.
  GradientAlignment(const CameraSpec& camera, const std::vector<Shot>& shots, const Rigid3& near,
                    const GradientOrientationOptions& options);

  struct Measure {
    double aligned = 0;    ///< sum |g1 . g2|
    double strength = 0;   ///< sum |g1| |g2|
    std::size_t seen = 0;  ///< points with a gradient in the images
    /// GOM = sum |g1 . g2| / sum |g1| |g2|, 0: all across, 1: all along; by chance 0.64. Both
    /// directions of a gradient are alike: what is bright to the LIDAR may be dark to the camera.
    double Gom() const { return strength > 0 ? aligned / strength : 0; }
  };
  Measure At(const Rigid3& camera_from_lidar) const;

 private:
  struct Gradients {
    // Point and a place a little farther along its gradient, in turn [m]; both are projected.
    std::vector<Eigen::Vector3f> pairs;
    std::vector<float> strength;
    cv::Mat along_x, along_y;  // CV_32FC1
  };

  Gradients Prepare(const Shot& shot, const cv::Mat& grey, const Rigid3& near, CloudFeature feature,
                    std::size_t most) const;
  void Add(const Gradients& shot, const Rigid3& camera_from_lidar, Measure* measure) const;

  Camera camera_;
  std::vector<Gradients> shots_;
};

/// `gom`: Taylor, Nieto and Johnson, Automatic calibration of multi-modal sensor systems using a
/// gradient orientation measure (IROS 2013): the pose at which gradients of clouds and of images
/// are aligned best, by a particle swarm in a box about `start`. No covariance: the paper has none.
/// Not converged, with a reason: few points in the images, the best at the box's border, no peak.
/// Throws InputError as GradientAlignment does.
SceneFit AlignByGradientOrientation(const CameraSpec& camera, const std::vector<Shot>& shots,
                                    const Rigid3& start,
                                    const GradientOrientationOptions& options = {});

}  // namespace rgbdt
