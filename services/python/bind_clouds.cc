#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "calib/files/image_files.h"
#include "calib/files/points/cloud_files.h"
#include "calib/model/cloud.h"
#include "calib/model/image.h"
#include "calib/model/rgbdt_cloud.h"
#include "services/python/arrays.h"
#include "services/python/bind.h"
#include "services/python/matrices.h"

namespace rgbdt::python {
namespace {

template <typename Owner, typename Value>
auto Column(std::vector<Value> Owner::*values) {
  return [values](const py::object& self) {
    return SharedOrNone(self.cast<const Owner&>().*values, self);
  };
}

// Of a fused cloud all columns are there, if perhaps of no point.
template <typename Value>
auto FusedColumn(std::vector<Value> RgbdtCloud::*values) {
  return [values](const py::object& self) {
    const auto& column = self.cast<const RgbdtCloud&>().*values;
    return Shared(column.data(), {Length(column.size())}, self);
  };
}

py::array Points(const py::object& self) { return Shared(self.cast<const Cloud&>().points, self); }

py::array FusedPoints(const py::object& self) {
  return Shared(self.cast<const RgbdtCloud&>().points, self);
}

py::array FusedColours(const py::object& self) {
  const auto& rgb = self.cast<const RgbdtCloud&>().rgb;
  return Shared(rgb.empty() ? nullptr : rgb[0].data(), {Length(rgb.size()), 3}, self);
}

py::array Pixels(const py::object& self) {
  const cv::Mat& pixels = self.cast<const Image&>().pixels;
  const py::ssize_t rows = pixels.rows, columns = pixels.cols, channels = pixels.channels();
  const auto of = [&](const auto* data) {
    const auto step = static_cast<py::ssize_t>(pixels.step[0]);
    const auto size = static_cast<py::ssize_t>(sizeof *data);
    if (channels == 1) return Shared(data, {rows, columns}, self, {step, size});
    return Shared(data, {rows, columns, channels}, self, {step, channels * size, size});
  };
  if (pixels.depth() == CV_16U) return of(pixels.ptr<std::uint16_t>());
  return of(pixels.ptr<std::uint8_t>());
}

void BindCloud(py::module_* module) {
  py::class_<Cloud, std::shared_ptr<Cloud>>(*module, "Cloud")
      .def_readonly("sweep_utime", &Cloud::sweep_utime)
      .def_readonly("first_line", &Cloud::first_line)
      .def_readonly("lines", &Cloud::lines)
      .def_readonly("beams", &Cloud::beams)
      .def_readonly("organised", &Cloud::organised)
      .def_property_readonly("points", &Points)
      .def_property_readonly("directions", Column(&Cloud::directions))
      .def_property_readonly("origins", Column(&Cloud::origins))
      .def_property_readonly("intensity", Column(&Cloud::intensity))
      .def_property_readonly("utime", Column(&Cloud::utime))
      .def_property_readonly("ring", Column(&Cloud::ring))
      .def("__len__", &Cloud::size);
  module->def(
      "read_cloud", [](const std::filesystem::path& path) { return ReadSweep(path); },
      py::arg("path"), py::call_guard<py::gil_scoped_release>());
}

void BindImage(py::module_* module) {
  py::class_<Image, std::shared_ptr<Image>>(*module, "Image")
      .def_readonly("camera", &Image::camera)
      .def_readonly("utime", &Image::utime)
      .def_readonly("exposure_s", &Image::exposure_s)
      .def_property_readonly("format", [](const Image& image) { return NameOf(image.format); })
      .def_property_readonly("pixels", &Pixels);
}

void BindFused(py::module_* module) {
  using Writer = void (*)(const std::filesystem::path&, const RgbdtCloud&);
  const auto write = [](Writer writer) {
    return [writer](const RgbdtCloud& cloud, const std::filesystem::path& path) {
      const py::gil_scoped_release release;
      writer(path, cloud);
    };
  };
  py::class_<RgbdtCloud, std::shared_ptr<RgbdtCloud>>(*module, "FusedCloud")
      .def_readonly("sweep_utime", &RgbdtCloud::sweep_utime)
      .def_readonly("cameras", &RgbdtCloud::cameras)
      .def_readonly("calibration_utime", &RgbdtCloud::calibration_utime)
      .def_property_readonly("map_from_lidar",
                             [](const RgbdtCloud& cloud) -> py::object {
                               if (!cloud.map_from_lidar) return py::none();
                               return Copied(MatrixOf(*cloud.map_from_lidar));
                             })
      .def_property_readonly("points", &FusedPoints)
      .def_property_readonly("rgb", &FusedColours)
      .def_property_readonly("intensity", FusedColumn(&RgbdtCloud::intensity))
      .def_property_readonly("utime", FusedColumn(&RgbdtCloud::utime))
      .def_property_readonly("temperature_k", FusedColumn(&RgbdtCloud::temperature_k))
      .def_property_readonly("temperature_sigma_k", FusedColumn(&RgbdtCloud::temperature_sigma_k))
      .def_property_readonly("thermal_counts", FusedColumn(&RgbdtCloud::thermal_counts))
      .def_property_readonly("valid", FusedColumn(&RgbdtCloud::valid))
      .def("write_ply", write(&WritePly), py::arg("path"))
      .def("write_pcd", write(&WritePcd), py::arg("path"))
      .def("__len__", &RgbdtCloud::size);
  module->def("read_fused", &ReadFused, py::arg("path"), py::call_guard<py::gil_scoped_release>());
}

}  // namespace

void BindClouds(py::module_* module) {
  BindCloud(module);
  BindImage(module);
  BindFused(module);
}

}  // namespace rgbdt::python
