#include "process/own_file.hpp"

#include <dlfcn.h>
#include <link.h>

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string>

namespace armwright {
namespace {

// The loader knows a library by the path with which it was opened. A relative one means nothing
// once the current folder has changed. The kernel's table has absolute paths.
std::filesystem::path find_mapped_file(const void* address) {
  const auto place = reinterpret_cast<std::uintptr_t>(address);
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) {
    std::uintptr_t begin = 0;
    std::uintptr_t end = 0;
    const std::size_t path = line.find('/');
    if (std::sscanf(line.c_str(), "%lx-%lx", &begin, &end) == 2 && begin <= place && place < end &&
        path != std::string::npos) {
      return line.substr(path);
    }
  }
  return {};
}

}  // namespace

OwnFile find_own_file() {
  static const char place = 0;
  Dl_info info{};
  link_map* object = nullptr;
  const bool is_known =
      dladdr1(&place, &info, reinterpret_cast<void**>(&object), RTLD_DL_LINKMAP) != 0;
  if (is_known && object != nullptr && *object->l_name != '\0') {  // the program has no name here
    return {.path = find_mapped_file(&place), .is_program = false};
  }
  std::error_code ignored;
  return {.path = std::filesystem::read_symlink("/proc/self/exe", ignored), .is_program = true};
}

}  // namespace armwright
