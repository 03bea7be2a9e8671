#include "optimizers/pagmo/pagmo_loader.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <link.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include "base/error.hpp"
#include "base/text.hpp"
#include "process/own_file.hpp"

namespace armwright {

#ifdef ARMWRIGHT_PAGMO_ID

namespace {

constexpr const char* kFile = "libarmwright_pagmo.so";
constexpr const char* kAgain =
    "install armwright again, or build the targets armwright and armwright_pagmo";

// Returns the place of the module: the first one that has it, or the first one of all.
std::filesystem::path find_module() {
  const std::filesystem::path folder = find_own_file().path.parent_path();
  const auto installed = folder.parent_path() / "lib" / "armwright" / kFile;
  const auto beside = folder / kFile;
  std::error_code ignored;
  return !std::filesystem::exists(installed, ignored) && std::filesystem::exists(beside, ignored)
             ? beside
             : installed;
}

// Returns why the file is no complete ELF file, as after an interrupted copy; empty if it is one.
// The loader would crash on a file that lacks its end. The table of sections is the last thing in a
// file.
std::string explain_incomplete(const std::filesystem::path& file) {
  ElfW(Ehdr) header{};
  std::ifstream stream(file, std::ios::binary);
  if (!stream.read(reinterpret_cast<char*>(&header), sizeof header) ||
      std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0) {
    return "is not a shared library";
  }
  std::error_code ignored;
  const std::uintmax_t size = std::filesystem::file_size(file, ignored);
  const std::uintmax_t wanted =
      header.e_shoff + std::uintmax_t{header.e_shentsize} * header.e_shnum;
  return size >= wanted ? "" : fmt::format("has only {} of its {} bytes", size, wanted);
}

}  // namespace

std::string explain_missing_pagmo() {
  const std::filesystem::path file = find_module();
  std::error_code ignored;
  return std::filesystem::exists(file, ignored)
             ? ""
             : fmt::format("its module {} is missing; {}", sanitize(file.string()), kAgain);
}

MakePagmoSearch* load_pagmo_module(std::string_view optimizer) {
  const std::filesystem::path file = find_module();
  const auto refuse = [&](const std::string& what) {
    throw Error(ErrorKind::bad_data, fmt::format("optimizer '{}': its module {} {}", optimizer,
                                                 sanitize(file.string()), what));
  };
  if (const std::string why = explain_missing_pagmo(); !why.empty()) {
    throw Error(ErrorKind::bad_data, fmt::format("optimizer '{}': {}", optimizer, why));
  }
  if (const std::string why = explain_incomplete(file); !why.empty()) {
    refuse(fmt::format("{}; {}", why, kAgain));
  }
  // The path is absolute, so the loader does not search. The module is never unloaded, because
  // exceptions and threads of pagmo may outlive an optimizer.
  void* const module = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (module == nullptr) {
    refuse(
        fmt::format("cannot be loaded: {}; install pagmo (on Debian: apt install libpagmo8), or "
                    "{}",
                    sanitize(dlerror()), kAgain));
  }
  const auto* const id = static_cast<const char*>(dlsym(module, kPagmoIdSymbol));
  void* const make_search = dlsym(module, kPagmoSearchSymbol);
  if (id == nullptr || make_search == nullptr) {
    refuse(
        fmt::format("lacks the symbols {} and {}; {}", kPagmoIdSymbol, kPagmoSearchSymbol, kAgain));
  }
  if (std::strcmp(id, ARMWRIGHT_PAGMO_ID) != 0) {
    refuse(
        fmt::format("belongs to another build of armwright: its id is {}, and this build needs "
                    "{}; {}",
                    sanitize(std::string_view(id, strnlen(id, 64))), ARMWRIGHT_PAGMO_ID, kAgain));
  }
  return reinterpret_cast<MakePagmoSearch*>(make_search);
}

#else

std::string explain_missing_pagmo() {
  return "built without pagmo (CMake option ARMWRIGHT_WITH_PAGMO is OFF)";
}

MakePagmoSearch* load_pagmo_module(std::string_view optimizer) {
  throw Error(ErrorKind::usage,
              fmt::format("optimizer '{}': {}", optimizer, explain_missing_pagmo()));
}

#endif

}  // namespace armwright
