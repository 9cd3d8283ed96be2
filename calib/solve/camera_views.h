#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

/// What one camera and the LIDAR see of the target in one view, as the solve takes it: the image,
/// and the one candidate of the cloud that is the target.
struct CameraView {
  std::string view;
  bool heldout = false;
  Utime image_utime = 0;
  const ImageEdges* image = nullptr;  ///< null: none found
  std::shared_ptr<const ImageEdges>
      turned_image;                           ///< holds `image` where it is not the detection's
  std::vector<const CloudEdges*> candidates;  ///< the detection's, of this camera
  std::optional<CloudEdges> cloud;            ///< the candidate taken; at first the likeliest
  std::string rejected;                       ///< why it takes no part; empty: it does
  bool copy = false;                          ///< rejected as another view's copy

  bool usable() const { return rejected.empty(); }
  /// It takes no part from here on. What was said first stays.
  void Reject(const std::string& why);
};

/// A camera's part of a view, with pointers into `detection`; rejected where image or cloud cannot
/// be used, with the reasons of both.
CameraView CameraViewOf(const std::string& camera, const ViewDetection& detection);

/// One camera's views, in the order of their names whatever order they came in, and what comes of
/// them.
struct CameraViews {
  const CameraSpec* spec = nullptr;
  std::vector<CameraView> all;
  /// Images of `all` that are not the detection's any more (PosedAgain).
  std::vector<std::shared_ptr<const ImageEdges>> posed_again;
  /// Candidates of `all` that are not the detection's any more (WithoutEncoderDelay).
  std::vector<std::shared_ptr<const CloudEdges>> turned_clouds;
  CameraReport report;

  std::vector<const CameraView*> Usable() const;
  /// Usable and not held out: the solver's.
  std::vector<const CameraView*> Used() const;
  /// The one that the solver uses of this name, null if there is none.
  const CameraView* Find(const std::string& view) const;
  /// Fills in which views are used, held out and rejected, and the time that detection took.
  void Describe();
};

/// `detections` must outlive the result. A view without an image of this camera is no view of it.
/// A board that is partly outside an image counts only where any camera sees it whole in some view.
/// A view whose image or cloud is another one's counts once.
CameraViews ViewsOf(const CameraSpec& camera, const std::vector<ViewDetection>& detections);

/// The same views with the target's pose in each image, how exact its corners are, and an outline
/// that was looked for in the wrong place, by another lens than the one that they were detected
/// with, and on a board of this shape (Target::BowFactors).
CameraViews PosedAgain(CameraViews camera, const Lens& lens, const Target& target,
                       const Eigen::Vector3d& bow_m = {0, 0, 0});

}  // namespace rgbdt
