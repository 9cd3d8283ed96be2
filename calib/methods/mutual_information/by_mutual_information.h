#pragma once

#include <cstddef>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/methods/mutual_information/joint_histogram.h"
#include "calib/methods/scene/particle_swarm.h"
#include "calib/methods/scene/pose_search.h"
#include "calib/model/rig.h"
#include "calib/model/shot.h"

namespace rgbdt {

// What the papers leave open, and what stands here. Values are taken between their 1st and 99th
// percentiles and counted in 64 bins (both papers: 256), of which the kernel is some four wide. An
// image is read between its pixels, a grey value shared between two bins: numeric gradients need
// that. The six unknowns weigh alike in units of a degree and 50 mm. The ascent is done twice, with
// differences of half a unit, which look over small bumps, and then of a tenth. Points hidden from
// the camera count, as in the papers, with the grey value of what hides them. On small synthetic
// scenes results lay 0.2 degrees and 10 mm off along the line from LIDAR to camera, a turn and a
// shift that make up for each other some 3 m away; hidden points are the likely reason.

struct MutualInformationOptions {
  std::size_t most_points = 20000;             ///< of all shots, an equal part of each
  std::size_t least_points = 300;              ///< in all images, at the result
  int bins = 64;                               ///< of reflectivity and of grey values
  PoseSteps unit{0.017453292519943295, 0.05};  ///< `mi`: of the unknowns
  double reach = 4;          ///< `mi`: how far from the start it may go, along any unknown [units]
  int max_iterations = 100;  ///< `mi`: of each ascent
  SwarmOptions swarm;        ///< `nmi`
  /// Share of the poses a unit away that have to be worse, or the result is no peak.
  double least_worse = 0.9;

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// The measures of both papers as functions of a camera's pose: LIDAR reflectivity against grey
/// value, over the points of all shots that lie in the images.
class ReflectivityAgainstGrey {
 public:
  /// `near`: points are looked for about where this pose sees them. Throws InputError for images
  /// that are not the camera's.
  ReflectivityAgainstGrey(const CameraSpec& camera, const std::vector<Shot>& shots,
                          const Rigid3& near, const MutualInformationOptions& options);

  JointHistogram At(const Rigid3& camera_from_lidar) const;
  Entropies EntropiesAt(const Rigid3& camera_from_lidar) const;

 private:
  struct Values {
    std::vector<Eigen::Vector3f> points;  // [m]
    std::vector<float> reflectivity;      // 0 to 1
    cv::Mat grey;                         // CV_32FC1, 0 to 1
  };

  Camera camera_;
  int bins_;
  std::vector<Values> shots_;
};

/// `mi`: Pandey, McBride, Savarese and Eustice (2012, 2015): the pose at which mutual information
/// is largest, by gradient ascent from `start`. The covariance is absent: the papers' bound, the
/// inverse of points times the measure's second derivatives, takes points as independent; on
/// synthetic scenes it stated 0.01 degrees and 1 mm where errors were 0.2 degrees and 10 mm (a
/// chi-square of 350 to 1700, of 6). Not converged, with a reason: clouds without
/// intensities, few points in the images, an ascent that goes astray, no peak. Throws InputError
/// for images that are not the camera's.
SceneFit AlignByMutualInformation(const CameraSpec& camera, const std::vector<Shot>& shots,
                                  const Rigid3& start,
                                  const MutualInformationOptions& options = {});

/// `nmi`: Taylor and Nieto (2012): the same by normalised mutual information and a particle swarm
/// in a box about `start`. No covariance: the paper has none.
SceneFit AlignByNormalisedMutualInformation(const CameraSpec& camera,
                                            const std::vector<Shot>& shots, const Rigid3& start,
                                            const MutualInformationOptions& options = {});

}  // namespace rgbdt
