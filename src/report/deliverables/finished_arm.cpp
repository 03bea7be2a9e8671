#include "report/deliverables/finished_arm.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"
#include "base/text.hpp"
#include "report/formats/run_traces.hpp"
#include "study/run/run.hpp"

namespace armwright {
namespace {

[[noreturn]] void refuse_run(const std::filesystem::path& folder, const std::string& what) {
  throw Error(ErrorKind::usage, fmt::format("{}: {}", sanitize(folder.string()), what));
}

void refuse_study(const std::filesystem::path& folder, std::string_view format) {
  if (std::filesystem::exists(folder / "manifest.json") ||
      !std::filesystem::exists(folder / "cells")) {
    return;
  }
  const FoundRuns found = find_runs(folder);
  const auto run = std::ranges::find_if(
      found.runs, [](const RunEntry& one) { return load_result(one.folder).tracking; });
  refuse_run(folder,
             run == found.runs.end()
                 ? fmt::format("this is a study of functions; {} is made of an arm's run", format)
                 : fmt::format("this is a study; {} is made of one run: give the folder of "
                               "one, such as {}",
                               format, sanitize(run->folder.string())));
}

}  // namespace

std::string FinishedArm::describe() const {
  return fmt::format("the winner of {} (seed {}) on {}", sanitize(result().optimizer),
                     result().seed, sanitize(result().problem));
}

FinishedArm load_finished_arm(const std::filesystem::path& folder, std::string_view format) {
  refuse_study(folder, format);
  const RunResult result = load_result(folder);
  if (!result.tracking) {
    refuse_run(folder, fmt::format("is a run on {}, which is a function and no arm; {} is made of "
                                   "an arm's run. csv, ioh, coco and json are there for all",
                                   sanitize(result.problem), format));
  }
  if (!result.winner) {
    refuse_run(folder, fmt::format("this run found no design that could be simulated to its end, "
                                   "so there is nothing to make {} of; optimize again with a "
                                   "larger budget or another start",
                                   format));
  }
  FinishedArm arm;
  arm.run = read_recorded_run(folder);
  if (arm.run.tracking() == nullptr) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: the arm of this run is not known any more. {} Bring these files "
                            "back as they were, or optimize again",
                            sanitize(folder.string()), arm.run.problem_fault));
  }
  arm.design = arm.run.tracking()->make_design(arm.run.find_best());
  return arm;
}

}  // namespace armwright
