// A folder for configuration files that a test writes and then fails to load.
#pragma once

#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "base/expect_error.hpp"
#include "base/temporary_folder.hpp"
#include "base/text.hpp"
#include "problems/config/design_file.hpp"
#include "problems/config/problem_loader.hpp"

namespace armwright {

// As messages list them.
inline constexpr const char* kShippedDesigns =
    "faithful-e6, faithful-e6-computed-torque, faithful-q1, faithful-q3, irb4600-start, robust-e6, "
    "robust-q1, "
    "robust-q3, table-a1, table-a10, table-a11, table-a5, table-a6, table-a7, table-a8, table-a9";

// What a message lists of these names, "a, b, c", in place of `typed`.
inline std::string list_near(const std::string& typed, std::string names, const char* command) {
  std::vector<std::string> valid;
  for (std::string& name : split(names, ',')) {
    valid.push_back(name.starts_with(' ') ? name.substr(1) : name);
  }
  return list_valid(typed, valid, command);
}
inline std::string list_designs(const std::string& typed) {
  return list_near(typed, kShippedDesigns, "armwright list designs");
}

class ProblemFolder {
 public:
  // base.toml is the least that makes a problem of the shipped arm.
  ProblemFolder() {
    write("base.toml",
          "kind = \"tracking\"\n[robot]\nurdf = \"irb4600_40_255\"\n"
          "[variables]\nstart = \"table-a1\"\n");
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name, std::ios::binary) << text;
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  LoadedProblem load(const std::string& name, std::span<const std::string> overrides = {}) const {
    return load_problem(path(name), overrides);
  }

  // What load_problem says to p.toml with this text; the folder left out of the message, so that
  // it begins "p.toml:".
  std::string refusal_of(const std::string& text,
                         const std::vector<std::string>& overrides = {}) const {
    write("p.toml", text);
    return shorten(usage_error_of([&] { load("p.toml", overrides); }));
  }
  // The same for base.toml with this text in addition, which begins in line 2.
  std::string refusal_of_base_with(const std::string& text) const {
    return refusal_of("extends = \"base\"\n" + text);
  }
  std::string refusal_of_design(const std::string& text) const {
    write("d.toml", text);
    return shorten(error_of(ErrorKind::bad_data, [&] { load_design(path("d.toml")); }));
  }

  std::string shorten(std::string message) const {
    const std::string folder = folder_.path().string();
    for (std::size_t at = message.find(folder); at != std::string::npos;
         at = message.find(folder, at)) {
      const bool inside = message.compare(at + folder.size(), 1, "/") == 0;
      message.replace(at, folder.size() + (inside ? 1 : 0), inside ? "" : "FOLDER");
    }
    return message;
  }

 private:
  TemporaryFolder folder_;
};

// One joint of a design file; any of its lines can be another one.
inline std::string make_joint(const std::string& p = "p_n_m_per_rad = 300",
                              const std::string& i = "i_n_m_per_rad_s = 2000",
                              const std::string& d = "d_n_m_s_per_rad = 5",
                              const std::string& least = "effort_min_n_m = -200",
                              const std::string& most = "effort_max_n_m = 200") {
  return "[[joint]]\n" + p + "\n" + i + "\n" + d + "\n" + least + "\n" + most + "\n";
}

}  // namespace armwright
