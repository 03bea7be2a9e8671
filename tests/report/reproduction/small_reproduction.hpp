// A reproduction that takes one second: one run of two generations, and two test cases per part.
#pragma once

#include <filesystem>
#include <string>

#include "base/file.hpp"
#include "base/temporary_folder.hpp"
#include "problems/config/config_files.hpp"
#include "report/reproduction/reproduction_config.hpp"
#include "report/reproduction/reproduction_plan.hpp"

namespace armwright {

class SmallReproduction {
 public:
  SmallReproduction() {
    constexpr std::size_t kLimit_bytes = std::size_t{1} << 20;
    write_file_atomically(
        path() / "_thesis.toml",
        read_file(find_config_folder() / "problems" / "_thesis.toml", kLimit_bytes));
    write_file_atomically(path() / "tiny.toml", R"(extends = "_thesis"
title = "A short run"
[sets]
validation_cases = 2
test_cases = 2
[run]
budget = 70
)");
    write_file_atomically(path() / "small.toml", R"(title = "Small"
optimizer = "ga"
seed = 1
engine = "articulated"
runs = [{label = "T1", problem = ")" + (path() / "tiny.toml").string() +
                                                     R"("}]
sweep = "q4-speed"
[[reevaluation]]
label = "T1, IK bug off"
run = "tiny"
set = ["task.ik_bug=false"]
[[figure]]
id = "fig-1"
title = "A run and a published design"
thesis = "Fig. 1"
series = [{name = "T1", of = "T1"}, {name = "A.8", of = "A.8"}]
[[difference]]
parts = ["A.9", "T1"]
reason = "The reason."
[[replay]]
id = "ramp"
title = "A replay"
of = "A.8"
beside = ["table-a1"]
training_case = "train/1:1"
[[momentary]]
name = "Ramp"
replay = "ramp"
)");
  }

  const std::filesystem::path& path() const { return folder_.path(); }

  // All parts have two cases.
  ReproductionRequest request() const {
    ReproductionRequest request;
    request.config = (path() / "small.toml").string();
    request.cases = 2;
    request.whole = true;
    return request;
  }

 private:
  TemporaryFolder folder_;
};

}  // namespace armwright
