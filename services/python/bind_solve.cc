#include <pybind11/functional.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <set>

#include "calib/files/schema/calibration_use.h"
#include "calib/files/schema/report_file.h"
#include "calib/files/session/session_dir.h"
#include "calib/fuse/fuse.h"
#include "calib/methods/calibrate_without.h"
#include "calib/methods/detect_session.h"
#include "calib/model/errors.h"
#include "calib/present/report/verdict.h"
#include "services/python/arrays.h"
#include "services/python/bind.h"

namespace rgbdt::python {
namespace {

struct Calibrated {
  Calibration calibration;
  Report report;
  std::vector<std::string> unreadable;
};

// What `rgbdt calibrate DIR` does, without a file written.
Calibrated CalibrateDir(const std::filesystem::path& dir, const std::string& method,
                        const std::set<std::string>& without, const Progress& progress) {
  CalibrateOptions options;
  options.method = method;
  options.Check();
  const Session session = OpenSession(dir);
  for (const std::string& view : without) {
    if (std::find(session.views.begin(), session.views.end(), view) == session.views.end()) {
      throw InputError("without: there is no view \"" + view + "\" in " + session.Title());
    }
  }
  SessionDetection detection = DetectSession(session, method, progress);
  if (detection.unreadable.size() == session.views.size()) {
    throw InputError("no view of " + session.Title() +
                     " could be read; the first: " + detection.unreadable.front());
  }
  Report report = WithUnlisted(CalibrateWithout(session.rig, detection.views, without, options),
                               session, detection.views);
  const std::filesystem::path truth = session.root / "truth.textproto";
  Calibration calibration = JudgedCalibration(report, session.rig);
  if (std::filesystem::exists(truth)) report = WithTruth(std::move(report), ReadTruth(truth));
  return {std::move(calibration), WithVerdicts(std::move(report)), std::move(detection.unreadable)};
}

// Called back from threads that do not hold the interpreter; what Python throws there is thrown on
// once nothing else runs.
Calibrated CalibrateSession(const std::filesystem::path& dir, const std::string& method,
                            const std::set<std::string>& without, const py::object& progress) {
  std::optional<py::error_already_set> thrown;
  const auto tell = [&](const std::string& line) {
    const py::gil_scoped_acquire acquire;
    if (progress.is_none() || thrown) return;
    try {
      progress(line);
    } catch (py::error_already_set& error) {
      thrown.emplace(std::move(error));
    }
  };
  Calibrated calibrated;
  {
    const py::gil_scoped_release release;
    calibrated = CalibrateDir(dir, method, without, tell);
  }
  if (thrown) throw std::move(*thrown);
  return calibrated;
}

RgbdtCloud FuseSound(const RigView& view, const Calibration& calibration, bool anyway) {
  const std::vector<std::string> against =
      RequireSound(calibration, *view.rig, {"the calibration", "the view's session"},
                   anyway ? Use::kAnyway : Use::kIfSound);
  for (const std::string& line : against) {
    if (PyErr_WarnEx(PyExc_UserWarning, ("used anyway: " + line).c_str(), 2) != 0) {
      throw py::error_already_set();
    }
  }
  const py::gil_scoped_release release;
  return FuseView(*view.rig, calibration, view.view);
}

}  // namespace

void BindSolve(py::module_* module) {
  py::class_<Calibrated>(*module, "Calibrated")
      .def_readonly("calibration", &Calibrated::calibration)
      .def_readonly("unreadable", &Calibrated::unreadable)
      .def_property_readonly("report_json",
                             [](const Calibrated& it) { return ReportToJson(it.report); })
      .def(
          "write_report",
          [](const Calibrated& it, const std::filesystem::path& path) {
            WriteReport(path, it.report);
          },
          py::arg("path"));
  module->def("calibrate", &CalibrateSession, py::arg("dir"), py::arg("method"), py::arg("without"),
              py::arg("progress"));
  module->def("fuse", &FuseSound, py::arg("view"), py::arg("calibration"), py::arg("anyway"));
}

}  // namespace rgbdt::python
