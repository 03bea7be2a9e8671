// The data of a page (web/src/data.ts), whatever the folder holds.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "base/stop_signal.hpp"
#include "report/evidence/page_options.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {

// JSON of what `folder` holds: a run, a study or a reproduction, finished or not. Nothing if
// stopped. Reads only: no lock is taken and nothing is written. Error{usage} if it holds none of
// them; Error{bad_data}; Error{io}.
std::optional<std::string> make_page_data(const std::filesystem::path& folder,
                                          const PageOptions& options, StopSignal& stop,
                                          RunObserver& observer);

// The data that stand in a page that make_page_html() made. Error{bad_data} if the file is none.
std::string read_page_data(const std::filesystem::path& page);
// Whether a file is such a page.
bool is_page_file(const std::filesystem::path& file);

// Of data, the page's title.
std::string get_page_title(std::string_view data);

}  // namespace armwright
