#pragma once

#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/observation.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// One camera's observations, in the order of their views whatever order they came in, and what
/// comes of them.
struct CameraViews {
  const CameraSpec* spec = nullptr;
  std::vector<Observation> all;
  CameraReport report;

  /// Neither rejected nor useless for other reasons.
  std::vector<const Observation*> Usable() const;
  /// Usable and not held out: the solver's.
  std::vector<const Observation*> Used() const;
  /// The solver's observation of a view, null if there is none.
  const Observation* Find(const std::string& view) const;
  /// Fills in which views are used, held out and rejected, and the time that detection took.
  void Describe();
};

CameraViews ViewsOf(const CameraSpec& camera, const std::vector<Observation>& observations);

}  // namespace rgbdt
