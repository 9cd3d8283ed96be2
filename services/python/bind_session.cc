#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "calib/files/session/session_dir.h"
#include "services/python/arrays.h"
#include "services/python/bind.h"

namespace rgbdt::python {
namespace {

// A session whose rig its views share.
struct OpenedSession {
  Session session;
  std::shared_ptr<const Rig> rig;
};

OpenedSession Open(const std::filesystem::path& dir) {
  Session session = OpenSession(dir);
  auto rig = std::make_shared<const Rig>(session.rig);
  return {std::move(session), std::move(rig)};
}

std::shared_ptr<RigView> ViewOf(const OpenedSession& opened, const std::string& name) {
  const std::vector<std::string>& views = opened.session.views;
  if (std::find(views.begin(), views.end(), name) == views.end()) {
    throw py::key_error("session " + opened.session.root.string() + " has no view \"" + name +
                        "\"");
  }
  const py::gil_scoped_release release;
  return std::make_shared<RigView>(RigView{opened.rig, ReadView(opened.session, name)});
}

std::vector<std::string> CamerasOf(const OpenedSession& opened) {
  std::vector<std::string> names;
  for (const CameraSpec& camera : opened.rig->cameras) names.push_back(camera.name);
  return names;
}

// The view's own cloud and images, which it keeps alive.
std::shared_ptr<Cloud> CloudOf(const std::shared_ptr<RigView>& view) {
  return {view, &view->view.cloud};
}

std::vector<std::shared_ptr<Image>> ImagesOf(const std::shared_ptr<RigView>& view) {
  std::vector<std::shared_ptr<Image>> images;
  for (Image& image : view->view.images) images.emplace_back(view, &image);
  return images;
}

}  // namespace

void BindSession(py::module_* module) {
  py::class_<RigView, std::shared_ptr<RigView>>(*module, "View")
      .def_property_readonly("name", [](const RigView& view) { return view.view.name; })
      .def_property_readonly("heldout", [](const RigView& view) { return view.view.heldout; })
      .def_property_readonly("cloud", &CloudOf)
      .def_property_readonly("images", &ImagesOf);
  py::class_<OpenedSession>(*module, "Session")
      .def_property_readonly("root",
                             [](const OpenedSession& opened) { return opened.session.root; })
      .def_property_readonly("views",
                             [](const OpenedSession& opened) { return opened.session.views; })
      .def_property_readonly("cameras", &CamerasOf)
      .def_property_readonly("rig_text",
                             [](const OpenedSession& opened) { return opened.rig->text; })
      .def_property_readonly("rig_hash",
                             [](const OpenedSession& opened) { return opened.rig->hash; })
      .def("view", &ViewOf, py::arg("name"));
  module->def("open_session", &Open, py::arg("dir"), py::call_guard<py::gil_scoped_release>());
}

}  // namespace rgbdt::python
