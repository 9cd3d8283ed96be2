#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "services/bus/log.h"
#include "services/messages/codec.h"
#include "services/python/arrays.h"
#include "services/python/bind.h"

namespace rgbdt::python {
namespace {

// What holds numbers by the thousand; None: another message, whose LCM type is as good.
py::object ArraysOf(Message message) {
  if (auto* image = std::get_if<Image>(&message)) return py::cast(std::move(*image));
  if (auto* chunk = std::get_if<CloudChunk>(&message)) return py::cast(std::move(chunk->cloud));
  if (auto* cloud = std::get_if<RgbdtCloud>(&message)) return py::cast(std::move(*cloud));
  return py::none();
}

py::object DecodeArrays(const std::string& channel, const std::string& bytes) {
  Message message = [&] {
    const py::gil_scoped_release release;
    return Decode(channel, reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  }();
  return ArraysOf(std::move(message));
}

}  // namespace

void BindLog(py::module_* module) {
  py::class_<LogEvent>(*module, "RawEvent")
      .def_readonly("number", &LogEvent::number)
      .def_readonly("receive_utime", &LogEvent::receive_utime)
      .def_property_readonly("channel",
                             [](const LogEvent& event) {  // anybody's bytes
                               PyObject* text = PyUnicode_DecodeUTF8(
                                   event.channel.data(),
                                   static_cast<Py_ssize_t>(event.channel.size()), "replace");
                               if (text == nullptr) throw py::error_already_set();
                               return py::reinterpret_steal<py::str>(text);
                             })
      .def_property_readonly("data", [](const LogEvent& event) {
        return py::bytes(reinterpret_cast<const char*>(event.bytes.data()), event.bytes.size());
      });
  py::class_<LogReader>(*module, "LogReader")
      .def(py::init([](const std::filesystem::path& path) {
             return std::make_unique<LogReader>(path.string());
           }),
           py::arg("path"))
      .def("next", &LogReader::Next)  // under the interpreter's lock: threads may share a log
      .def_property_readonly("unreadable_bytes", &LogReader::unreadable_bytes);
  module->def("decode_arrays", &DecodeArrays, py::arg("channel"), py::arg("data"));
}

}  // namespace rgbdt::python
