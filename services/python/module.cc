// The native part of `import rgbdt`: rgbdt/__init__.py beside is what users see.
#include <exception>

#include "calib/model/errors.h"
#include "calib/model/text.h"
#include "calib/model/version.h"
#include "services/python/bind.h"

PYBIND11_MODULE(_core, module) {
  namespace python = rgbdt::python;
  module.attr("__version__") = rgbdt::Version();
  // Python takes nothing but UTF-8, and a message may quote a file's bytes.
  static const pybind11::exception<rgbdt::InputError> input_error(module, "InputError",
                                                                  PyExc_ValueError);
  // NOLINTNEXTLINE(performance-unnecessary-value-param): pybind11 has it so
  pybind11::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const rgbdt::InputError& error) {
      PyErr_SetString(input_error.ptr(), rgbdt::ValidUtf8(error.what()).c_str());
    }
  });
  python::BindClouds(&module);
  python::BindCalibration(&module);
  python::BindSession(&module);
  python::BindSolve(&module);
  python::BindLog(&module);
}
