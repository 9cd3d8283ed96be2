#pragma once

#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/methods/scene/pose_search.h"
#include "calib/model/rig.h"
#include "calib/model/shot.h"

namespace rgbdt {

// What the paper leaves open, and what stands here. Steps begin at half a degree and 25 mm and are
// halved wherever no neighbour is better, down to 0.02 degrees and 1 mm; the transform is read
// between its pixels. The paper's probability compares F_C with two normal distributions that it
// learnt on its own car: here the share itself is asked to be high, over neighbours half a degree
// and 25 mm away.

struct EdgeGridOptions {
  double least_step_m = 0.3;        ///< depth discontinuities below are noise
  double alpha = 1.0 / 3;           ///< share of an edge itself in the transform
  double gamma = 0.98;              ///< what is left of an edge a pixel away
  std::size_t most_points = 20000;  ///< of a shot; evenly left out beyond
  std::size_t least_points = 100;   ///< at discontinuities, in all images, at the result
  PoseSteps first_step{0.5 * 0.017453292519943295, 0.025};
  int halvings = 5;                                ///< of that step
  PoseSteps reach{4 * 0.017453292519943295, 0.2};  ///< farther from the start: not converged
  double least_worse = 0.95;                       ///< F_C below: not converged

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// The paper's objective as a function of a camera's pose: sum of X D over the points at
/// discontinuities, of all shots, that lie in the images (eq. 1).
class EdgesOnEdges {
 public:
  /// `near`: points are looked for about where this pose sees them. Throws InputError for images
  /// that are not the camera's.
  EdgesOnEdges(const CameraSpec& camera, const std::vector<Shot>& shots, const Rigid3& near,
               const EdgeGridOptions& options);

  struct Sum {
    double value = 0;
    std::size_t seen = 0;  ///< points that lie in the images
  };
  Sum At(const Rigid3& camera_from_lidar) const;

 private:
  struct Edges {
    std::vector<Eigen::Vector3f> points;  // [m]
    std::vector<float> weight;
    cv::Mat field;  // CV_32FC1
  };

  Camera camera_;
  std::vector<Edges> shots_;
};

/// `edge-grid`: Levinson and Thrun, Automatic Online Calibration of Cameras and Lasers (RSS 2013):
/// of the 729 poses on a grid about the best one so far the best, until none is better. No
/// covariance: the paper has none. Not converged, with a reason: few discontinuities in the images,
/// a search that went astray, a low F_C (ShareWorse). Throws InputError for images that are not the
/// camera's.
SceneFit AlignByEdgeGrid(const CameraSpec& camera, const std::vector<Shot>& shots,
                         const Rigid3& start, const EdgeGridOptions& options = {});

}  // namespace rgbdt
