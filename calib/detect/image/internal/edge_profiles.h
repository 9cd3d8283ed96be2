#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace rgbdt {

/// An edge that a profile across a curve shows.
struct ProfileEdge {
  double offset_px = 0;  ///< from the curve along its normal
  double strength = 0;   ///< the gradient there over its noise; always positive
  bool dark = false;     ///< beside it the image is clipped at black
  bool bright = false;   ///< beside it the image is saturated
};

/// The image across one place of a curve.
struct Profile {
  double along_px = 0;  ///< from the curve's first point
  bool inside = false;  ///< whether it lies in the image at all
  std::vector<ProfileEdge> edges;
};

/// A curve sampled evenly, about a pixel apart.
struct Curve {
  std::vector<Eigen::Vector2d> points;   ///< [px]
  std::vector<Eigen::Vector2d> normals;  ///< unit, in the image
  double step_px = 0;                    ///< between two points
};

/// Of a pixel's value, from differences over some pixels: neighbours of a demosaiced image share
/// noise, and texture is mostly wider. CV_32FC1.
double NoiseOf(const cv::Mat& grey);

/// Profiles across every point of a curve, from `inner_px` (negative) to `outer_px` along the
/// normals: all local extrema of the gradient across the curve, of either sign, that stand out
/// 4 sigma of `noise`. Within 3 px of clipped pixels they are not where they seem, and are marked.
/// `clipped` is what Clipped() says of the image. Smoothed by a Gaussian of 0.8 px, which moves no
/// straight edge.
std::vector<Profile> ProfilesAcross(const cv::Mat& grey, const cv::Mat& clipped, const Curve& curve,
                                    double inner_px, double outer_px, double noise);

}  // namespace rgbdt
