// The native part of `import rgbdt`: rgbdt/__init__.py beside is what users see.
#include "calib/model/errors.h"
#include "calib/model/version.h"
#include "services/python/bind.h"

PYBIND11_MODULE(_core, module) {
  namespace python = rgbdt::python;
  module.attr("__version__") = rgbdt::Version();
  pybind11::register_exception<rgbdt::InputError>(module, "InputError", PyExc_ValueError);
  python::BindClouds(&module);
  python::BindCalibration(&module);
  python::BindSession(&module);
  python::BindSolve(&module);
  python::BindLog(&module);
}
