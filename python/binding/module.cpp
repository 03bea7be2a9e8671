// The module armwright._armwright: the functions of the library that the package in
// python/armwright needs, with plain numbers, arrays and JSON. Users see only the package, and its
// docstrings explain everything.
#include <pybind11/pybind11.h>

#include "base/build_info.hpp"
#include "base/error.hpp"
#include "parts.hpp"
#include "problems/config/config_files.hpp"

namespace armwright::python {
namespace {

const char* get_exception(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::usage:
      return "UsageError";
    case ErrorKind::bad_data:
      return "BadDataError";
    case ErrorKind::busy:
      return "BusyError";
    case ErrorKind::io:
      break;
  }
  return "IoError";
}

void translate(std::exception_ptr pointer) {
  try {
    if (pointer) {
      std::rethrow_exception(pointer);
    }
  } catch (const Error& error) {
    const auto type = py::module_::import("armwright.errors").attr(get_exception(error.kind()));
    PyErr_SetString(type.ptr(), error.what());
  }
}

}  // namespace

PYBIND11_MODULE(_armwright, module) {
  module.doc() = "The inside of the package armwright.";
  py::register_exception_translator(translate);
  module.def("version", get_version);
  module.def("config_folder", [] { return find_config_folder().string(); });
  module.def("list_configs", [](const std::string& kind) { return list_configs(kind); });
  module.def("resolve_config", [](const std::string& kind, const std::string& name) {
    return resolve_config(kind, name).string();
  });
  add_problems(module);
  add_optimizers(module);
  add_runs(module);
  add_studies(module);
}

}  // namespace armwright::python
