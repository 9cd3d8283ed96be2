#pragma once

#include <string>
#include <vector>

#include "calib/model/view_detection.h"
#include "calib/solve/camera_views.h"
#include "tests/unit/matchers.h"

namespace rgbdt {

/// An ideal world: a rectangular board's outline seen through a lens, one pixel wide, and its
/// boundary in the LIDAR frame without noise. What is left to a solver is the pixel grid.
struct BoardWorld {
  CameraSpec spec;
  Rigid3 camera_from_lidar;  ///< the truth
  std::vector<ViewDetection> views;

  /// Those not held out, in their order; the world must outlive them.
  std::vector<CameraView> Used() const;
};

std::vector<const CameraView*> PointersTo(const std::vector<CameraView>& views);

/// 640x480, f = 500 px, distorted.
CameraSpec WorldCamera();

/// LIDAR x forward, y left, z up to camera x right, y down, z forward, somewhat off.
Rigid3 WorldTruth();

/// A board's view: its edge pixels are the rounded projected outline.
ViewDetection DetectBoard(const CameraSpec& spec, const Rigid3& camera_from_lidar,
                          const Rigid3& lidar_from_board, const std::string& view);

/// `count` views, 2 to 4.5 m away all over the image, tilted and turned; every third held out.
BoardWorld MakeBoardWorld(int count, std::uint32_t seed = 1);

/// A guess `angle` [rad] and `shift` [m] off.
Rigid3 GuessOff(const Rigid3& truth, double angle, double shift, std::uint32_t seed);

}  // namespace rgbdt
