#include "study/compare/study_settings.hpp"

#include "study/compare/study_plan.hpp"

namespace armwright {
namespace {

// Everything that may be left out is there once.
constexpr const char* kSpecimen = R"(
title = ""
problems = ["sphere"]
optimizers = ["random"]
set = []
schedule = "fixed:5"
[[problem]]
name = "sphere"
set = []
schedule = "fixed:5"
[[optimizer]]
name = "random"
options = []
set = []
schedule = "fixed:5"
inputs = []
[[target]]
label = "t"
problems = ["sphere"]
value = 1
failures = 1
)";

const std::vector<SettingWords>& get_words() {
  static const std::vector<SettingWords> words = {
      {"title", "one line, for lists and reports"},
      {"description", "some lines more"},
      {"name", "of the study's folder (default: the file's name)"},
      {"problems", "names of problems, instead of [[problem]]"},
      {"optimizers", "names of optimizers, instead of [[optimizer]]"},
      {"set", "KEY=VALUE, what is changed about every problem"},
      {"budget", "training cases that every run may simulate; required, here or by --budget"},
      {"replicates", "runs of every optimizer on every problem"},
      {"seed", "of the study: draws starts, training cases and the optimizers' streams"},
      {"schedule",
       "which training cases: fixed:K, fresh:K or coevolution:K (default: fixed, K as "
       "the problem has it)"},
      {"start_spread", "width of the box that starts are drawn from, as a share of the bounds"},
      {"baselines", "whether random search and a local search are in the pool by themselves"},
      {"checkpoints", "budgets, logarithmically spaced, at which incumbents are tested"},
      {"first_checkpoint", "the smallest of them, in cases"},
      {"constraint_tolerance",
       "by how much a constraint may be violated on validation and test "
       "sets"},
      {"final_engine",
       "another engine, on which the best designs are simulated once more; empty: "
       "none"},
      {"value",
       "what a run is worth: the winner's objective on the test set, or the share of test "
       "cases in which it fails"},
      {"reference",
       "label of the optimizer that running times to targets are divided by; empty: "
       "none"},
      {"plan_sha256", "of a resolved plan: hash of all that follows"},
      {"selection.last", "the last N incumbents are judged on the validation set"},
      {"selection.best", "and the N with the best training objective"},
      {"selection.along",
       "the candidates of all checkpoints are judged, not only those of the end"},
      {"problem[].name", "a shipped problem or a file"},
      {"problem[].label", "what tables and folders call it (default: its name)"},
      {"problem[].set", "KEY=VALUE, what is changed about it"},
      {"problem[].schedule", "its own schedule"},
      {"problem[].configuration_sha256",
       "of a resolved plan: hash of the configuration it was "
       "made with"},
      {"problem[].training_set", "of a resolved plan: for the reader"},
      {"problem[].validation_set", "of a resolved plan: for the reader"},
      {"problem[].test_set", "of a resolved plan: for the reader"},
      {"optimizer[].name", "as --optimizer takes it"},
      {"optimizer[].label", "what tables and folders call it (default: its name)"},
      {"optimizer[].options", "KEY=VALUE, its options"},
      {"optimizer[].schedule", "its own schedule, which makes a method of it"},
      {"optimizer[].set",
       "KEY=VALUE of [racing], [schedule], [perturbation] or control.controller, "
       "likewise"},
      {"optimizer[].baseline", "of a resolved plan: it was not asked for"},
      {"optimizer[].description", "of a resolved plan: what an optimizer in Python says of itself"},
      {"optimizer[].inputs", "of a resolved plan: hashes of a plugin's files"},
      {"target[].label", "a fixed target, by which tables name it"},
      {"target[].problems", "labels of the problems that it is asked of (default: all)"},
      {"target[].value", "the objective on the test set at most"},
      {"target[].failures", "this many failing test cases at most"},
  };
  return words;
}

}  // namespace

std::vector<Setting> list_study_settings() {
  const std::vector<std::vector<AskedKey>> documents = {
      ask_study_keys(ConfigTable::parse(kSpecimen, "a study"))};
  return make_settings(documents, get_words());
}

}  // namespace armwright
