#include "study/compare/plugin_consent.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/file_descriptor.hpp"
#include "base/folder_checksums.hpp"
#include "base/hash.hpp"
#include "base/text.hpp"
#include "optimizers/plugins/recorded_optimizer.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "process/command_words.hpp"

namespace armwright {
namespace {

using nlohmann::json;

// Returns a text that says what would run, for example "exec:python3 mine.py" or "the library
// /home/me/mine.so".
std::string describe_plugin(const NamedOptimizer& optimizer) {
  std::string text = optimizer.name;
  if (is_plugin(optimizer.name) && optimizer.name.find("exec:") == std::string::npos) {
    text = "the library " + join(list_plugin_files(optimizer.name), ", ");
  }
  for (const std::string& option : optimizer.options) {
    text += option.starts_with("log=") ? ", which writes to a file (" + option + ")" : "";
  }
  return text;
}

// Returns the hash of what would run. A file that is missing has no hash.
std::string calc_plugin_hash(std::span<const NamedOptimizer> optimizers) {
  json list = json::array();
  for (const NamedOptimizer& optimizer : optimizers) {
    json files = json::object();
    if (is_plugin(optimizer.name)) {
      for (const std::string& file : list_plugin_files(optimizer.name)) {
        std::error_code ignored;
        files[file] =
            std::filesystem::is_regular_file(file, ignored) ? calc_program_hash(file) : "";
      }
    }
    list.push_back({{"name", optimizer.name}, {"options", optimizer.options}, {"files", files}});
  }
  return calc_sha256_hex(list.dump(-1, ' ', true, json::error_handler_t::replace));
}

// Returns the user's folder for state that outlives a session (XDG Base Directory Specification).
std::optional<std::filesystem::path> find_state_folder() {
  const char* const state = std::getenv("XDG_STATE_HOME");
  if (state != nullptr && std::filesystem::path(state).is_absolute()) {
    return std::filesystem::path(state);
  }
  const char* const home = std::getenv("HOME");
  if (home != nullptr && std::filesystem::path(home).is_absolute()) {
    return std::filesystem::path(home) / ".local" / "state";
  }
  return std::nullopt;
}

// What this user's state says about the study of a folder.
class StudyMemory {
 public:
  explicit StudyMemory(const std::filesystem::path& folder) {
    std::error_code error;
    study_ = std::filesystem::weakly_canonical(folder, error);
    if (error) {
      study_ = folder;
    } else if (const auto state = find_state_folder()) {
      constexpr std::size_t kDigits = 32;
      file_ =
          *state / "armwright" / "studies" / calc_sha256_hex(study_.string()).substr(0, kDigits);
    }
  }

  const std::filesystem::path& study() const { return study_; }

  bool holds(const std::string& hash) const {
    constexpr std::size_t kLimit_bytes = std::size_t{64} << 10;
    std::error_code ignored;
    if (file_.empty() || !std::filesystem::is_regular_file(file_, ignored)) {
      return false;
    }
    try {
      return read_file(file_, kLimit_bytes) == make_content(hash);
    } catch (const Error&) {
      return false;
    }
  }

  void write(const std::string& hash) const {
    if (file_.empty() || holds(hash)) {
      return;
    }
    std::error_code ignored;
    const auto folder = file_.parent_path();
    std::filesystem::create_directories(folder.parent_path().parent_path(), ignored);
    ::mkdir(folder.parent_path().c_str(), 0700);
    ::mkdir(folder.c_str(), 0700);
    const std::string fresh = fmt::format("{}.{}", file_.string(), ::getpid());
    FileDescriptor file(
        ::open(fresh.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600));
    if (!file.is_open()) {
      return;
    }
    const std::string content = make_content(hash);
    const bool is_whole =
        ::write(file.get(), content.data(), content.size()) == static_cast<ssize_t>(content.size());
    if (file.close() != 0 || !is_whole || ::rename(fresh.c_str(), file_.c_str()) != 0) {
      ::unlink(fresh.c_str());
    }
  }

 private:
  std::string make_content(const std::string& hash) const {
    return hash + "\n" + study_.string() + "\n";
  }

  std::filesystem::path study_;
  std::filesystem::path file_;  // empty if this user has no state folder
};

}  // namespace

bool is_record_of_study(const std::filesystem::path& file) {
  const auto folder = file.parent_path();  // of a file in the current folder it is empty
  std::error_code ignored;
  return file.filename() == "study.toml" &&
         std::ranges::any_of(std::array{kChecksumFile, "cells", "attempts"}, [&](const char* name) {
           return std::filesystem::exists(std::filesystem::symlink_status(folder / name, ignored));
         });
}

bool needs_consent(const NamedOptimizer& optimizer) {
  return is_plugin(optimizer.name) || optimizer.is_problem ||
         std::ranges::any_of(optimizer.options,
                             [](const std::string& option) { return option.starts_with("log="); });
}

std::vector<NamedOptimizer> list_programs(std::span<const StudyProblem> problems) {
  std::vector<NamedOptimizer> programs;
  for (const StudyProblem& problem : problems) {
    const LoadedProblem& loaded = problem.loaded;
    const json resolved = json::parse(loaded.resolved_json);
    const bool is_command = resolved.value("kind", "") == "command";
    if (!loaded.program.empty() && (is_command || !is_host_name(loaded.program))) {
      programs.push_back({.name = loaded.program, .is_problem = true});
      for (const auto& [file, hash] : loaded.input_hashes) {
        programs.back().options.push_back(fmt::format("{} {}", file, hash));
      }
      if (is_command) {  // texts of input files and words of categories may be scripts
        programs.back().options.push_back(
            fmt::format("configuration {}", calc_sha256_hex(resolved.dump())));
      }
    }
  }
  return programs;
}

void require_consent(const std::filesystem::path& folder,
                     std::span<const NamedOptimizer> optimizers, const AskUser& ask) {
  std::vector<NamedOptimizer> plugins(optimizers.begin(), optimizers.end());
  std::erase_if(plugins, [](const NamedOptimizer& one) { return !needs_consent(one); });
  if (plugins.empty()) {
    return;
  }
  const StudyMemory memory(folder);
  const std::string hash = calc_plugin_hash(plugins);
  if (memory.holds(hash)) {
    return;
  }
  std::vector<std::string> targets;
  std::ranges::transform(plugins, std::back_inserter(targets), describe_plugin);
  const std::string study = sanitize(memory.study().string());
  const std::string list = sanitize(join(targets, "; "));
  if (!ask || !ask(fmt::format("the study in {} would run, with all of your rights: {}. Run it?",
                               study, list))) {
    throw Error(ErrorKind::usage,
                fmt::format("the study in {} would run, with all of your rights: {}. You did not "
                            "start this study on this machine with these plugins. If you trust "
                            "them, repeat the command with --trust (in Python: trust=True); show, "
                            "report and export need no plugin (docs/plugins.md)",
                            study, list));
  }
  memory.write(hash);
}

void remember_study(const std::filesystem::path& folder, std::span<const StudyProblem> problems) {
  std::vector<NamedOptimizer> plugins = read_recorded_optimizers(folder / "study.toml");
  std::ranges::move(list_programs(problems), std::back_inserter(plugins));
  std::erase_if(plugins, [](const NamedOptimizer& one) { return !needs_consent(one); });
  if (!plugins.empty()) {
    StudyMemory(folder).write(calc_plugin_hash(plugins));
  }
}

}  // namespace armwright
