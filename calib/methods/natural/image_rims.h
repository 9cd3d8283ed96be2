#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "calib/model/image.h"

namespace rgbdt {

/// An edge of the image that a line across it meets.
struct ImageRim {
  double offset = 0;       ///< along the line [px of the level]
  Eigen::Vector2d normal;  ///< unit, of the edge: along its gradient, either way
  double strength = 0;     ///< of the gradient, 0 to 1: over what is usual in this image
};

/// The gradients of an image, made coarser by 2^level, and the edges that a line meets in it.
class ImageRims {
 public:
  /// `grey`: CV_32FC1, of the whole image.
  ImageRims(const cv::Mat& grey, int level);

  double pixels() const { return pixels_; }  ///< of the image in one of the level's
  /// The level's pixel of one of the image's.
  Eigen::Vector2d ToLevel(const Eigen::Vector2d& pixel) const {
    return ((pixel.array() + 0.5) / pixels_ - 0.5).matrix();
  }
  bool Contains(const Eigen::Vector2d& at) const {
    return at.x() >= 1 && at.y() >= 1 && at.x() < gradient_.cols - 2 && at.y() < gradient_.rows - 2;
  }
  /// Where the gradient along the line through `at` in direction `normal` is largest, within
  /// +-reach [px of the level]; the strongest ones, eight at most, in the order of their offsets.
  void Meet(const Eigen::Vector2d& at, const Eigen::Vector2d& normal, int reach,
            std::vector<ImageRim>* rims) const;

 private:
  Eigen::Vector2d GradientAt(const Eigen::Vector2d& at) const;

  double pixels_ = 1;
  cv::Mat gradient_;  // CV_32FC2: by x and by y
  double usual_ = 0;  // length of a gradient that is an edge
};

}  // namespace rgbdt
