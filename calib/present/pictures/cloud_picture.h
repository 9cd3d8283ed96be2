#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>

#include "calib/model/rgbdt_cloud.h"

namespace rgbdt {

/// What the points' colour shows.
enum class CloudColour { kRgb, kThermal, kIntensity };

struct DrawOptions {
  int width = 1600, height = 1000;     ///< [px]
  double field_of_view_deg = 50;       ///< across the width, 10 to 150; without `eye` it is chosen
  std::optional<Eigen::Vector3d> eye;  ///< LIDAR frame [m]; absent: behind, above and aside
  std::optional<Eigen::Vector3d> look_at;  ///< LIDAR frame [m]; absent: what has colour
  bool white_background = false;
  double point_size = 1;  ///< times the size that closes the gaps of a dense sweep
  bool notes = true;      ///< caption, axes of the LIDAR frame and where it stands
  std::string title;      ///< begins the caption; ASCII

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// A picture (CV_8UC3, BGR) of the fused cloud in perspective, from a place other than the LIDAR's,
/// so that its depth shows: discs as large as the beams' spacing, nearest in front, holes between
/// them closed, depth steps darkened (eye-dome lighting, Boucheny 2009). Points without the colour
/// asked for are dim grey, by intensity. Thermal (degrees Celsius; raw counts where there is no
/// temperature) and intensity come with a legend whose range is the 1st to 99th percentile. The
/// viewpoint does not depend on the colour. The same input gives the same picture. Throws
/// InputError where vectors differ in length, or naming the bad option.
cv::Mat DrawCloud(const RgbdtCloud& cloud, CloudColour colour, const DrawOptions& options = {});

/// Both in one, RGB left and thermal right, each as large as the options say (Figure 1 of the
/// paper), 8 px apart.
cv::Mat DrawSideBySide(const RgbdtCloud& cloud, const DrawOptions& options = {});

}  // namespace rgbdt
