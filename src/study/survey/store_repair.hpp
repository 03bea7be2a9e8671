// Repairs a store (a run, study or reproduction) by making a copy without its damaged parts. The
// command that made the store can resume the copy and reaches exactly the result of an undamaged
// store. The original is only read.
//
// The copy of a damaged run has its manifest and a new journal. The journal has every intact record
// that is still valid, also behind damage, but not the end record: lost evaluations are simulated
// again. Derived files are left out, because they are derived again. Damaged files are kept as
// NAME.damaged. If a run of a study or reproduction has lost its manifest, its folder is kept as
// FOLDER.damaged, and the run is made again.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "base/stop_signal.hpp"
#include "study/survey/store_survey.hpp"

namespace armwright {

struct RunRepair {
  std::filesystem::path name;    // as RunSurvey::name
  bool is_set_aside = false;     // the whole folder was kept aside; the run is made again
  bool has_new_journal = false;  // the numbers below describe the new journal
  JournalRepair journal = {};
  std::uint64_t evaluations_kept = 0;
  std::uint64_t evaluations_lost = 0;        // as far as known
  std::vector<std::string> kept_aside = {};  // damaged files, renamed to NAME.damaged
  std::vector<std::string> made_again = {};  // derived files that the copy lacks
};

struct StoreRepair {
  std::filesystem::path copy;
  std::vector<RunRepair> runs;                    // only the damaged ones
  std::vector<std::filesystem::path> kept_aside;  // damaged files outside of runs (NAME.damaged)
  std::vector<std::filesystem::path> left_out;    // entries that are not files, folders or links
};

// Makes the copy completely or not at all (folder_copy.hpp). Returns nothing and makes no copy if
// the store has no damage. Throws Error{busy} while a process writes the store, Error{usage} if
// `target` exists or lies in the store, and Error{io}. Throws Error{bad_data} if the store's record
// is lost: the manifest of a run, or the plan of a study. Throws WorkStopped if `stop` ends the
// copy.
std::optional<StoreRepair> repair_store(const std::filesystem::path& folder,
                                        const std::filesystem::path& target, StopSignal& stop);

}  // namespace armwright
