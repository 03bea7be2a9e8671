// Makes the data of a page (web/src/data.ts) from a folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/stop_signal.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {

class ProgressMeter;

// How a page of any kind is made.
struct PageOptions {
  unsigned jobs = 1;               // threads
  std::vector<std::string> cases;  // "test/2:17": replayed in addition to the usual cases
  bool simulate = true;  // false: parts that need a simulation are left out, and a note says so
  ProgressMeter* meter = nullptr;  // set by `armwright watch`: the page shows the progress
};

// What a folder holds.
enum class PageKind : std::uint8_t { run, study, reproduction };
const char* to_string(PageKind kind);  // "a run"
// Throws Error{usage} if the folder does not exist or holds nothing of this.
PageKind find_page_kind(const std::filesystem::path& folder);

// Each of the next five functions returns the JSON of a page, or nothing after a request to stop.
// They only read the folder and take no lock, so the folder may belong to a run in progress. They
// throw Error{usage} if the folder does not hold what they expect or a case of the options does not
// exist; Error{bad_data} for damaged files; Error{io}.

// Makes the page of a run, a study or a reproduction, whichever the folder holds.
std::optional<std::string> make_page_data(const std::filesystem::path& folder,
                                          const PageOptions& options, StopSignal& stop,
                                          RunObserver& observer);

// Makes RunData of web/src/data.ts. The same folder gives the same bytes for any number of threads.
// If the problem cannot be rebuilt as it was, the page has no parts that need it, and its notes say
// so.
std::optional<std::string> make_run_page(const std::filesystem::path& folder,
                                         const PageOptions& options, StopSignal& stop,
                                         RunObserver& observer);

// Makes StudyData of web/src/data.ts from study.toml, the cells' cell.json and the final checks. It
// does not read journals. The same folder gives the same bytes for any number of threads. The
// numbers of an unfinished study are those of its finished cells; only problems with all of their
// cells have ranks, tests and pairs.
std::optional<std::string> make_study_page(const std::filesystem::path& folder,
                                           const PageOptions& options, StopSignal& stop,
                                           RunObserver& observer);

// Makes ReproductionData of web/src/data.ts from the folder's record. Only the motions of the
// replays are simulated. The page of an unfinished reproduction has the results that exist.
std::optional<std::string> make_reproduction_page(const std::filesystem::path& folder,
                                                  const PageOptions& options, StopSignal& stop,
                                                  RunObserver& observer);

// Makes ComparisonData of web/src/data.ts from the folders of two runs or two studies. Throws
// Error{usage} for another pair. The motions of two runs are those of both winners on common cases;
// studies are compared without simulations.
std::optional<std::string> make_comparison_page(const std::filesystem::path& a,
                                                const std::filesystem::path& b,
                                                const PageOptions& options, StopSignal& stop,
                                                RunObserver& observer);

// Returns the title of a page from its data.
std::string get_page_title(std::string_view data);

}  // namespace armwright
