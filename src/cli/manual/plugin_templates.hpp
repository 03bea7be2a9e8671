// The files that `armwright new-plugin` and `armwright new-problem` write: a small optimizer or
// problem that works and that the user replaces by an own one.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace armwright {

// One language that a kind of plugin can be written in. In all texts, @NAME@ is the plugin's name,
// @CLASS@ its name in PascalCase, @PLUGIN@ the value for the command line, @LANGUAGE@ the language,
// @SOURCE@ the source file and @STEPS@ the build step.
struct TemplateLanguage {
  const char* name;
  const char* suffix;
  const char* source;
  const char* compiler;      // as CMake names it; nullptr if there is nothing to build
  const char* standard;      // the feature of CMake for it
  const char* plugin;        // how the command line names the plugin in its folder
  const char* problem_file;  // nullptr if there is none
};

struct TemplateKind {
  std::span<const TemplateLanguage> languages;
  const char* readme;
  const char* test_begin;  // of test.sh, before the steps that build the plugin
  const char* test_end;
};

extern const TemplateKind kPluginTemplates;   // optimizers
extern const TemplateKind kProblemTemplates;  // problems

// Returns the names of the languages, the usual one first.
std::vector<std::string> list_languages(const TemplateKind& kind);

struct PluginFile {
  std::string name;
  std::string content;
  bool is_program = false;  // whether it gets the permission to be executed
};

// Returns the files of a plugin named `name` (a snake_case identifier) in one of list_languages().
// The list is empty for any other language.
std::vector<PluginFile> make_files(const TemplateKind& kind, std::string_view language,
                                   std::string_view name);

}  // namespace armwright
