// The optimizers that `armwright new-plugin` begins with, one in each language: the same method.
// @NAME@ is the plugin's name, @CLASS@ the same in PascalCase.
#pragma once

namespace armwright {

extern const char* const kCppPlugin;
extern const char* const kCPlugin;
extern const char* const kPythonPlugin;

}  // namespace armwright
