#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/rig.h"
#include "calib/model/rigid3.h"
#include "calib/model/statistics.h"

namespace rgbdt {

/// What is solved for besides fx fy cx cy; the numbers not named stay 0.
enum class LensChoice {
  kPinhole5,  ///< k1 k2 p1 p2 k3
  kPinhole8,  ///< k1 k2 p1 p2 k3 k4 k5 k6: OpenCV's rational model
  kFisheye,   ///< k1 k2 k3 k4, equidistant
};

/// The checkerboard's inner corners in one image.
struct IntrinsicsView {
  std::string name;  ///< for messages
  /// Pixels of the distorted image, in the target's order or half a turn off it.
  std::vector<Eigen::Vector2d> corners;
};

/// All images of one camera in a session.
struct CameraCorners {
  std::string camera;
  int images = 0;
  std::vector<IntrinsicsView> views;   ///< where the checkerboard was found, in the session's order
  std::vector<double> contrasts;       ///< between its squares, of each view [DN or counts]
  std::vector<std::string> not_found;  ///< where it was not
  /// Images that are another one's copy, to the last bit of their corners; left out.
  std::vector<std::string> copies{};
};

/// What the intrinsic calibration of one camera is made from.
struct IntrinsicsInput {
  LensChoice choice = LensChoice::kPinhole5;
  int width = 0, height = 0;  ///< of the images [px]
  Target target;
  std::vector<IntrinsicsView> views;

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// One view in the result, in the input's order.
struct IntrinsicsViewFit {
  std::string name;
  std::string rejected;       ///< why it was left out; empty: it was used
  double rms_px = 0;          ///< length of the residuals, over the corners used
  double worst_px = 0;        ///< longest residual of all corners, also of those left out
  int worst_corner = 0;       ///< its index in the target's order
  int corners_left_out = 0;   ///< wrong corners of a view that was used
  Rigid3 camera_from_target;  ///< half a turn off where the corners were
  std::vector<bool> used;     ///< of each corner
  std::vector<Eigen::Vector2d> residuals_px;  ///< measured - predicted, of each corner
};

/// Which part of the image held corners that were used.
struct ImageCoverage {
  int columns = 8, rows = 6;
  std::vector<int> corners;  ///< in each cell, row by row from the top left
  double fraction = 0;       ///< of the cells, how many held a corner

  bool Holds(int column, int row) const {
    return corners[static_cast<std::size_t>(row * columns + column)] > 0;
  }
  /// Of the image's nine parts ("top left", "middle", ...) those of which less than half was
  /// covered.
  std::vector<std::string> EmptyParts() const;
};

/// How the board differs from its drawing, as the views have it.
struct BoardShape {
  Estimate aspect;               ///< the squares' height over their width, less one
  Estimate bow_x, twist, bow_y;  ///< Target::BowFactors [m]; above 0, the middle is nearer
};

/// A camera's lens and its uncertainty.
struct IntrinsicsResult {
  Lens lens;
  LensChoice choice = LensChoice::kPinhole5;
  bool converged = false;
  std::string detail;  ///< where it is not: why, and what to do
  double rms_px = 0;   ///< length of the residuals, over all corners used
  int corners_used = 0;
  std::vector<std::string> names;  ///< of what was solved for: fx fy cx cy k1 ...
  std::vector<double> values;      ///< in that order
  /// In that order, scaled with the variance of the residuals; empty where it is not known.
  Eigen::MatrixXd covariance;
  std::optional<BoardShape> board;  ///< absent: taken as drawn
  std::vector<IntrinsicsViewFit> views;
  ImageCoverage coverage;

  /// 1 sigma of value i; infinite where the covariance is not known.
  double Sigma(int i) const;
  int ViewsUsed() const;
};

/// Another lens model on the same images.
struct LensAlternative {
  LensChoice choice = LensChoice::kPinhole5;
  bool converged = false;
  double rms_px = 0;  ///< over the corners that this model uses
  /// Of the model that was asked for, over the same corners.
  double asked_rms_px = 0;
  /// Difference of the Bayesian information criterion (Schwarz 1978), this less the one asked for:
  /// n ln(RSS/RSS_asked) + (k - k_asked) ln n, of n coordinates and k numbers of the lens. Below 0:
  /// the images want this one.
  double bic = 0;
};

/// What the images say of the lens model that was asked for.
struct LensComparison {
  LensChoice asked = LensChoice::kPinhole5;
  std::vector<LensAlternative> others;
  /// The one of `others` that the images want instead; absent: none.
  std::optional<LensAlternative> better;
};

/// What a rig file states of the lens, made from those of `views` (the input's) that were used; the
/// result must have a covariance. k4, k5 and k6 of the rational model are taken as known there, so
/// the others' covariance is that given them.
LensUncertainty UncertaintyOf(const IntrinsicsResult& result,
                              const std::vector<IntrinsicsView>& views);

}  // namespace rgbdt
