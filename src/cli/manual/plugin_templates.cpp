#include "cli/manual/plugin_templates.hpp"

#include <cctype>

#include "cli/manual/plugin_template_texts.hpp"

namespace armwright {
namespace {

// @NAME@ is the plugin's name, @PLUGIN@ what --optimizer takes.

constexpr const char* kCmakeCpp = R"raw(cmake_minimum_required(VERSION 3.25)
project(@NAME@ LANGUAGES CXX)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
find_package(armwright REQUIRED COMPONENTS plugin)

add_library(@NAME@ MODULE @NAME@.cpp)
target_compile_features(@NAME@ PRIVATE cxx_std_20)
target_link_libraries(@NAME@ PRIVATE armwright::plugin)
)raw";

constexpr const char* kCmakeC = R"raw(cmake_minimum_required(VERSION 3.25)
project(@NAME@ LANGUAGES C)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
find_package(armwright REQUIRED COMPONENTS plugin)

add_library(@NAME@ MODULE @NAME@.c)
set_target_properties(@NAME@ PROPERTIES C_STANDARD 99)
target_link_libraries(@NAME@ PRIVATE armwright::plugin m)
)raw";

constexpr const char* kReadme = R"raw(# @NAME@

An optimizer for armwright, begun with `armwright new-plugin --language @LANGUAGE@ @NAME@`.

- `@SOURCE@` is the optimizer; replace its minimize().
- `./test.sh` @STEPS@ checks it and runs it on the sphere.

Then:

    armwright optimize q1-complex --optimizer '@PLUGIN@'
)raw";

constexpr const char* kTestBegin = R"raw(#!/bin/sh
# Is the plugin all right? ARMWRIGHT names another program than the armwright on the PATH,
# CMAKE_PREFIX_PATH another place where it is installed.
set -eu
cd "$(dirname "$0")"
armwright=${ARMWRIGHT:-armwright}
)raw";

constexpr const char* kTestBuild = R"raw(cmake -S . -B build
cmake --build build
)raw";

constexpr const char* kTestEnd = R"raw(plugin='@PLUGIN@'
"$armwright" check-plugin "$plugin"
results=$(mktemp -d)
trap 'rm -rf "$results"' EXIT
"$armwright" optimize sphere --optimizer "$plugin" --budget 1000 --out "$results/run"
)raw";

struct Language {
  const char* name;
  const char* suffix;
  const char* source;
  const char* cmake;   // nullptr: there is nothing to build
  const char* plugin;  // as --optimizer takes it, in the plugin's folder
};

const Language kLanguages[] = {
    {"c++", ".cpp", kCppPlugin, kCmakeCpp, "./build/lib@NAME@.so"},
    {"c", ".c", kCPlugin, kCmakeC, "./build/lib@NAME@.so"},
    {"python", ".py", kPythonPlugin, nullptr, "exec:python3 @NAME@.py"},
};

std::string to_pascal_case(std::string_view name) {
  std::string pascal;
  bool is_first = true;
  for (const char c : name) {
    if (c == '_') {
      is_first = true;
      continue;
    }
    pascal += is_first ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
    is_first = false;
  }
  return pascal;
}

std::string replace_all(std::string text, std::string_view what, std::string_view with) {
  for (std::size_t at = text.find(what); at != std::string::npos;
       at = text.find(what, at + with.size())) {
    text.replace(at, what.size(), with);
  }
  return text;
}

}  // namespace

std::vector<std::string> plugin_languages() {
  std::vector<std::string> names;
  for (const Language& language : kLanguages) {
    names.emplace_back(language.name);
  }
  return names;
}

std::vector<PluginFile> make_plugin_files(std::string_view language_name, std::string_view name) {
  std::vector<PluginFile> files;
  for (const Language& language : kLanguages) {
    if (language.name != language_name) {
      continue;
    }
    const std::string source = std::string(name) + language.suffix;
    const auto fill = [&](std::string text) {
      text = replace_all(text, "@PLUGIN@", language.plugin);
      text = replace_all(text, "@SOURCE@", source);
      text = replace_all(text, "@LANGUAGE@", language.name);
      text = replace_all(text, "@STEPS@ ", language.cmake == nullptr ? "" : "builds it, ");
      text = replace_all(text, "@CLASS@", to_pascal_case(name));
      return replace_all(text, "@NAME@", name);
    };
    files.push_back({source, fill(language.source)});
    if (language.cmake != nullptr) {
      files.push_back({"CMakeLists.txt", fill(language.cmake)});
    }
    files.push_back({"README.md", fill(kReadme)});
    files.push_back(
        {"test.sh",
         fill(std::string(kTestBegin) + (language.cmake == nullptr ? "" : kTestBuild) + kTestEnd),
         true});
  }
  return files;
}

}  // namespace armwright
