// What report, plot and watch make pages of.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cli/terminal/arguments.hpp"

namespace armwright {

struct Session;

struct PageInput {
  std::string source;
  std::vector<std::string> cases;
  JobsOption jobs;
  bool quiet = false;

  // The argument FOLDER and the flags.
  void add_to(CLI::App& command);
  // The data: of a folder computed, with progress on stderr; of a page's file those that stand in
  // it. Nothing if stopped.
  std::optional<std::string> make_data(Session& session) const;
};

}  // namespace armwright
