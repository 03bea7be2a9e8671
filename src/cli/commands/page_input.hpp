// The input of the commands report and plot: the folder or page that they read.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cli/terminal/arguments.hpp"

namespace armwright {

struct Session;

// The argument FOLDER and the flags --case, --jobs and --quiet.
struct PageInput {
  std::string source;
  std::string other = {};  // a second folder, to compare with; empty if there is none
  std::vector<std::string> cases;
  std::string jobs;
  bool quiet = false;

  void add_to(CLI::App& command);
  // Returns the page's data as JSON. If `source` is a folder, the data are computed, with progress
  // on stderr. With a second folder they are those of a comparison. If it is a page, they are read from its file. Returns nothing if the user stopped
  // it. Throws Error{usage} if cases are named for a page, and Error{bad_data} or Error{io} if the
  // source cannot be read.
  std::optional<std::string> make_data(Session& session) const;
};

}  // namespace armwright
