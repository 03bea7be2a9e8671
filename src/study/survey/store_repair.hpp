// A copy of a store without what is damaged in it, which the command that made it goes on with to
// the very result of one that was never damaged. The original is only read.
//
// Of a damaged run the copy has the manifest and a journal of the intact records that can still be
// true, those behind damage too, without the record that ends the run: what is lost is evaluated
// again. What was derived from the journal is left out, as it is made again. Damaged files are kept
// beside as NAME.damaged; a run of a study or reproduction whose manifest is lost is kept as a
// whole as FOLDER.damaged, and made anew.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "base/stop_signal.hpp"
#include "study/survey/store_survey.hpp"

namespace armwright {

struct RunRepair {
  std::filesystem::path name;    // as RunSurvey's
  bool is_set_aside = false;     // as a whole: it is made anew
  bool has_new_journal = false;  // the numbers below are of it
  JournalRepair journal = {};
  std::uint64_t evaluations_kept = 0;
  std::uint64_t evaluations_lost = 0;        // as far as can be told
  std::vector<std::string> kept_aside = {};  // damaged files, as NAME.damaged
  std::vector<std::string> made_again = {};  // derived files that are not in the copy
};

struct StoreRepair {
  std::filesystem::path copy;
  std::vector<RunRepair> runs;                    // the damaged ones
  std::vector<std::filesystem::path> kept_aside;  // damaged files of no run, as NAME.damaged
  std::vector<std::filesystem::path> left_out;    // what is neither file nor folder nor link
};

// The copy is made whole or not at all (folder_copy.hpp). Nothing if there is no damage, and
// nothing is made. Error{busy} while a process writes the store; Error{usage} if `target` exists or
// lies in the store; Error{bad_data} if its record (the manifest of a run, the plan of a study) is
// lost; Error{io}. CopyStopped if `stop` ends it.
std::optional<StoreRepair> repair_store(const std::filesystem::path& folder,
                                        const std::filesystem::path& target, StopSignal& stop);

}  // namespace armwright
