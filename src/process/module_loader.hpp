// Modules: shared libraries of armwright's own that the program loads on demand, because the
// libraries that they need take long to load. cmake/module.cmake makes them.
//
// The place of a module follows from that of the file with this code, the program or a shared
// library; no variable and no current folder matters:
//   PREFIX/lib/armwright, for PREFIX/bin/armwright and PREFIX/lib/libarmwright.so (also in the
//   build tree) and PREFIX/lib/TRIPLET/libarmwright.so, or else the folder of that file, for the
//   Python package and programs of users.
#pragma once

#include <string>
#include <string_view>

namespace armwright {

struct Module {
  const char* name;      // of libarmwright_NAME.so
  const char* id;        // of the one that belongs to this build; empty: the build has none
  const char* library;   // that it contains or needs: "pagmo"
  const char* option;    // the CMake option of the library
  const char* packages;  // Debian's packages with it
};
extern const Module kCeresModule;
extern const Module kPagmoModule;

// Returns why the module cannot be loaded: the build is without it, or there is no such file. Loads
// nothing. Empty if there is a file.
std::string explain_missing(const Module& module);

// Loads the module, which then stays loaded, and returns the address of its function `entry`. Every
// call checks the module again, which costs microseconds. `user` needs the module, for messages:
// "optimizer 'pagmo:de'". Throws Error{bad_data} if the module is missing or incomplete, belongs to another build, or needs a library that is not installed.
void* load_module(const Module& module, const char* entry, std::string_view user);

// The symbol of every module's id, a text.
inline constexpr const char* kModuleIdSymbol = "armwright_module_id";

}  // namespace armwright
