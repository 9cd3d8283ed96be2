#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "calib/files/schema/calibration_file.h"
#include "calib/files/schema/proto_convert.h"
#include "calib/files/schema/report_file.h"
#include "services/python/arrays.h"
#include "services/python/bind.h"
#include "services/python/matrices.h"

namespace rgbdt::python {
namespace {

Eigen::Matrix3d CameraMatrix(const Lens& lens) {
  Eigen::Matrix3d matrix;
  matrix << lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1;
  return matrix;
}

py::object CovarianceOf(const CameraCalibration& camera) {
  if (!camera.covariance) return py::none();
  return Copied(*camera.covariance);
}

std::optional<Lens> LensOf(const CameraCalibration& camera) {
  if (!camera.lens) return std::nullopt;
  return camera.lens->lens;
}

std::string StatusOf(const CameraCalibration& camera) {
  return proto::SolveStatus_Name(text::FromStatus(camera.status));
}

CameraCalibration CameraOf(const Calibration& calibration, const std::string& name) {
  const CameraCalibration* found = calibration.Find(name);
  if (found == nullptr) throw py::key_error("the calibration has no camera \"" + name + "\"");
  return *found;
}

std::vector<std::string> NamesOf(const Calibration& calibration) {
  std::vector<std::string> names;
  for (const CameraCalibration& camera : calibration.cameras) names.push_back(camera.camera);
  return names;
}

void BindLens(py::module_* module) {
  py::class_<Lens>(*module, "Lens")
      .def_property_readonly("model",
                             [](const Lens& lens) {
                               return lens.model == Lens::Model::kPinhole ? "pinhole" : "fisheye";
                             })
      .def_property_readonly("camera_matrix",
                             [](const Lens& lens) { return Copied(CameraMatrix(lens)); })
      .def_property_readonly("distortion", [](const Lens& lens) {
        const std::size_t count = lens.model == Lens::Model::kPinhole ? 8 : 4;
        return py::array_t<double>(Length(count), lens.distortion.data());
      });
}

void BindCameraCalibration(py::module_* module) {
  py::class_<CameraCalibration>(*module, "CameraCalibration")
      .def_readonly("camera", &CameraCalibration::camera)
      .def_property_readonly("camera_from_lidar",
                             [](const CameraCalibration& camera) {
                               return Copied(MatrixOf(camera.camera_from_lidar));
                             })
      .def_property_readonly("quaternion_wxyz",
                             [](const CameraCalibration& camera) {
                               const Eigen::Quaterniond& q = camera.camera_from_lidar.rotation;
                               return std::array<double, 4>{q.w(), q.x(), q.y(), q.z()};
                             })
      .def_property_readonly("translation_m",
                             [](const CameraCalibration& camera) {
                               const Eigen::Vector3d& t = camera.camera_from_lidar.translation;
                               return std::array<double, 3>{t.x(), t.y(), t.z()};
                             })
      .def_property_readonly("covariance", &CovarianceOf)
      .def_property_readonly("status", &StatusOf)
      .def_readonly("detail", &CameraCalibration::detail)
      .def_property_readonly("converged", &CameraCalibration::converged)
      .def_property_readonly("lens", &LensOf);
}

}  // namespace

void BindCalibration(py::module_* module) {
  BindLens(module);
  BindCameraCalibration(module);
  py::class_<Calibration, std::shared_ptr<Calibration>>(*module, "Calibration")
      .def_readonly("method", &Calibration::method)
      .def_readonly("rig_hash", &Calibration::rig_hash)
      .def_readonly("utime", &Calibration::utime)
      .def_property_readonly("cameras", &NamesOf)
      .def("__getitem__", &CameraOf, py::arg("camera"))
      .def("__len__", [](const Calibration& calibration) { return calibration.cameras.size(); })
      .def("__iter__",
           [](const Calibration& calibration) { return py::iter(py::cast(NamesOf(calibration))); })
      .def(
          "__contains__",
          [](const Calibration& calibration, const std::string& camera) {
            return calibration.Find(camera) != nullptr;
          },
          py::arg("camera"))
      .def("keys", &NamesOf)
      .def("items",
           [](const Calibration& calibration) {
             std::vector<std::pair<std::string, CameraCalibration>> items;
             for (const CameraCalibration& camera : calibration.cameras) {
               items.emplace_back(camera.camera, camera);
             }
             return items;
           })
      .def("__str__", &PrintCalibration)
      .def(
          "write",
          [](const Calibration& calibration, const std::filesystem::path& path) {
            WriteCalibration(path, calibration);
          },
          py::arg("path"));
  module->def("read_calibration", &ReadCalibration, py::arg("path"));
  module->def(
      "read_report_json",
      [](const std::filesystem::path& path) { return ReportToJson(ReadReport(path)); },
      py::arg("path"));
}

}  // namespace rgbdt::python
