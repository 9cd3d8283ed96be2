#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/cloud.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"

namespace rgbdt::study {

/// What people give wrong in a rig file, or in what lies beside it, or do while views are taken.
struct Mistake {
  std::string name;  ///< "none": the rig as it is
  int size = 0;      ///< 1 small, 2 middling, 3 large
};

/// All of them, each at its three sizes; the first is "none". Those of a pattern only where there
/// is one.
std::vector<Mistake> AllMistakes(const Target& target);

/// The rig with the mistake in it.
Rig WithMistake(const Mistake& mistake, Rig rig);

/// The cloud of view `view` of so many with the mistake in it: scaled; turned, as the mount was
/// bumped when two thirds of the views were taken; moved, as in one view the board was.
Cloud WithMistake(const Mistake& mistake, Cloud cloud, std::size_t view, std::size_t views);

/// Whether it changes what is found of a board in a cloud: its size, or the cloud.
bool IsOfTheCloud(const Mistake& mistake);

/// By how many views images and clouds are apart.
int ViewsApart(const Mistake& mistake);

/// Detections with each cloud's part taken from the view so many farther on; those that have none
/// are left out.
std::vector<ViewDetection> PairedApart(std::vector<ViewDetection> views, int apart);

/// Whether a cause's name, or a reason's first words, say what the mistake was.
bool Names(const Mistake& mistake, const std::string& cause);

/// The causes that a person reads first of a camera, the likeliest first, two at most: those of its
/// verdict or, where it has no pose, what its rejected views say.
std::vector<std::string> CausesRead(const CameraReport& camera);

}  // namespace rgbdt::study
