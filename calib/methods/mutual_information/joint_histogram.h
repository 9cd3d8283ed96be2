#pragma once

#include <opencv2/core/mat.hpp>

namespace rgbdt {

/// Entropies [nat] of two variables, each by itself and both together.
struct Entropies {
  double x = 0, y = 0, joint = 0;

  /// MI(X, Y) = H(X) + H(Y) - H(X, Y), eq. 4 of Pandey et al. (2012). 0: independent.
  double MutualInformation() const { return x + y - joint; }
  /// (H(X) + H(Y)) / H(X, Y) of Studholme et al. (1999), as Taylor and Nieto (2012) take it; 1:
  /// independent, 2: each tells the other.
  double Normalised() const { return joint > 0 ? (x + y) / joint : 1; }
};

/// Of a joint density, CV_64FC1, x in rows, y in columns, of any positive sum; all zero: zeros.
Entropies EntropiesOf(const cv::Mat& joint);

/// Pairs of values from 0 to 1, counted.
class JointHistogram {
 public:
  explicit JointHistogram(int bins) : counts_(cv::Mat::zeros(bins, bins, CV_64FC1)) {}

  /// A pair; y is shared between the two bins next to it, so that the counts change smoothly with
  /// it. Both must lie between 0 and 1.
  void Add(double x, double y);

  double count() const { return count_; }
  const cv::Mat& counts() const { return counts_; }

  /// The kernel density: the counts under a Gaussian, along each axis of the bandwidth 1.06 sigma
  /// n^(-1/5) (Silverman 1986), sigma being the values' own. What would leave the histogram is
  /// reflected at its border.
  cv::Mat Density() const;

 private:
  cv::Mat counts_;
  double count_ = 0, sum_x_ = 0, sum_y_ = 0, sum_xx_ = 0, sum_yy_ = 0;
};

}  // namespace rgbdt
