#include "process/module_loader.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <link.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <vector>

#include "base/error.hpp"
#include "base/text.hpp"
#include "process/own_file.hpp"

namespace armwright {
namespace {

constexpr const char* kAgain = "install armwright again, or build it again with its modules";

// Returns the place of the module: the first one that has it, or the first one of all.
std::filesystem::path find_module(const Module& module) {
  const std::string name = fmt::format("libarmwright_{}.so", module.name);
  const OwnFile own = find_own_file();
  const std::filesystem::path folder = own.path.parent_path();
  std::vector<std::filesystem::path> places = {folder.parent_path() / "lib" / "armwright" / name};
  if (!own.is_program) {
    places.push_back(folder.parent_path() / "armwright" / name);
  }
  places.push_back(folder / name);
  std::error_code ignored;
  const auto found = std::ranges::find_if(
      places, [&](const auto& place) { return std::filesystem::exists(place, ignored); });
  return found != places.end() ? *found : places.front();
}

// Returns why the file is no complete ELF file, as after an interrupted copy; empty if it is one.
// The loader would crash on a file that lacks its end. The table of sections is the last thing in a
// file.
std::string explain_incomplete(const std::filesystem::path& file) {
  ElfW(Ehdr) header{};
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) {  // opening a pipe would wait for ever
    return "is not a file";
  }
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    return fmt::format("cannot be read ({})", std::generic_category().message(errno));
  }
  if (!stream.read(reinterpret_cast<char*>(&header), sizeof header) ||
      std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0) {
    return "is not a shared library";
  }
  const std::uintmax_t size = std::filesystem::file_size(file, ignored);
  const std::uintmax_t wanted =
      header.e_shoff + std::uintmax_t{header.e_shentsize} * header.e_shnum;
  return size >= wanted ? "" : fmt::format("has only {} of its {} bytes", size, wanted);
}

}  // namespace

std::string explain_missing(const Module& module) {
  if (*module.id == '\0') {
    return fmt::format("built without {} (CMake option {} is OFF)", module.library, module.option);
  }
  const std::filesystem::path file = find_module(module);
  std::error_code ignored;
  return std::filesystem::exists(file, ignored)
             ? ""
             : fmt::format("its module {} is missing; {}", sanitize(file.string()), kAgain);
}

void* load_module(const Module& module, const char* entry, std::string_view user) {
  if (const std::string why = explain_missing(module); !why.empty()) {
    throw Error(ErrorKind::bad_data, fmt::format("{}: {}", user, why));
  }
  const std::filesystem::path file = find_module(module);
  const auto refuse = [&](const std::string& what) {
    throw Error(ErrorKind::bad_data, fmt::format("{}: its module {} {}; {}", user,
                                                 sanitize(file.string()), what, kAgain));
  };
  if (const std::string why = explain_incomplete(file); !why.empty()) {
    refuse(why);
  }
  // The path is absolute, so the loader does not search. The module is never unloaded, because
  // exceptions and threads of its libraries may outlive their user.
  void* const opened = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (opened == nullptr) {
    refuse(fmt::format("cannot be loaded: {}; install what it needs (on Debian: apt install {})",
                       sanitize(dlerror()), module.packages));
  }
  const auto* const id = static_cast<const char*>(dlsym(opened, kModuleIdSymbol));
  void* const function = dlsym(opened, entry);
  if (id == nullptr || function == nullptr) {
    refuse(fmt::format("lacks the symbols {} and {}", kModuleIdSymbol, entry));
  }
  if (std::strcmp(id, module.id) != 0) {
    refuse(
        fmt::format("belongs to another build of armwright: its id is {}, and this build needs "
                    "{}",
                    sanitize(std::string_view(id, strnlen(id, 64))), module.id));
  }
  return function;
}

}  // namespace armwright
