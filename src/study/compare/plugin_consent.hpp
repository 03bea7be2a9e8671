// Consent to run the plugins and the programs of problems that a recorded study names. Both run with
// all rights of the user, and people send each other study folders. So a plugin of a recorded plan runs only if
// this user started the study on this machine with the same plugins, or agrees.
//
// $XDG_STATE_HOME/armwright/studies (default: ~/.local/state) has one file per study that this user
// started. Its name is a hash of the study's folder. It holds a hash over the plugins: their names,
// their options and the content of their files. A missing or unwritable state folder makes no run
// fail; the user is then asked each time.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "study/compare/study_plan.hpp"
#include "study/compare/study_reader.hpp"

namespace armwright {

// Returns whether a study's file may be the record of a study: it lies in the folder of a study that
// has begun, under the name of the record. Such a file may lack its hash, because somebody changed it.
bool is_record_of_study(const std::filesystem::path& file);

// Returns whether the optimizer of a recorded plan needs consent: it is a plugin, or it has an
// option that names a file to write to, which recorded plans never have.
bool needs_consent(const NamedOptimizer& optimizer);

// Returns the programs of the problems, each as an optimizer that needs consent: its options are the
// hashes of its files.
std::vector<NamedOptimizer> list_programs(std::span<const StudyProblem> problems);

// Does nothing if none of the optimizers needs consent, or if this user started the study of the
// folder with the same plugins. Otherwise asks `ask` and remembers a yes. Throws
// Error{usage}, with the folder and what would run, if the answer is no or `ask` is empty.
void require_consent(const std::filesystem::path& folder,
                     std::span<const NamedOptimizer> optimizers, const AskUser& ask);

// Remembers that this user started the study with the plugins that its recorded plan names, and with
// the programs of its problems. Does nothing if there are none or if the state folder cannot be
// written. Throws Error{usage} or Error{io} if the recorded plan cannot be read.
void remember_study(const std::filesystem::path& folder, std::span<const StudyProblem> problems);

}  // namespace armwright
