#pragma once

#include <pybind11/pybind11.h>

#include <memory>

#include "calib/model/rig.h"
#include "calib/model/view_detection.h"

namespace rgbdt::python {

/// A view with the rig that saw it.
struct RigView {
  std::shared_ptr<const Rig> rig;
  View view;
};

// Each adds its part to the module.
void BindClouds(pybind11::module_* module);       ///< Cloud, Image, FusedCloud
void BindCalibration(pybind11::module_* module);  ///< Lens, CameraCalibration, Calibration, reports
void BindSession(pybind11::module_* module);      ///< Session, View; after clouds
void BindSolve(pybind11::module_* module);        ///< calibrate, fuse; after all of these
void BindLog(pybind11::module_* module);          ///< LogReader, decode

}  // namespace rgbdt::python
