// Finds, checks and loads the module libarmwright_pagmo.so. Its place follows from that of the file
// with this code, the program or a shared library; no variable and no current folder matters:
//   PREFIX/lib/armwright, for PREFIX/bin/armwright and PREFIX/lib/libarmwright.so (also in the
//   build tree), or else the folder of that file, for the Python package and programs of users.
#pragma once

#include <string>
#include <string_view>

#include "optimizers/pagmo_module/pagmo_module.hpp"

namespace armwright {

// Returns why no module can be loaded: the build is without pagmo, or there is no such file. Loads
// nothing. Empty if there is a file.
std::string explain_missing_pagmo();

// Loads the module, which then stays loaded. Every call checks it again, which costs microseconds.
// Throws Error{bad_data} with the optimizer's name if the file is missing, is incomplete, belongs to
// another build, or needs a library that is not installed.
MakePagmoSearch* load_pagmo_module(std::string_view optimizer);

}  // namespace armwright
