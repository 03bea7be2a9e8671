#include "report/page/page_data.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/folder.hpp"
#include "report/reproduction/reproduction.hpp"
#include "study/compare/study_folder.hpp"

namespace armwright {

const char* to_string(PageKind kind) {
  constexpr const char* kNames[] = {"a run", "a study", "a reproduction"};
  return kNames[static_cast<std::size_t>(kind)];
}

PageKind find_page_kind(const std::filesystem::path& folder) {
  if (!path_exists(folder)) {
    throw Error(ErrorKind::usage, fmt::format("{}: there is no such folder", folder.string()));
  }
  if (is_study_folder(folder)) {
    return PageKind::study;
  }
  if (is_reproduction_folder(folder)) {
    return PageKind::reproduction;
  }
  if (path_exists(folder / "manifest.json")) {
    return PageKind::run;
  }
  throw Error(ErrorKind::usage,
              fmt::format("{}: is the folder of neither a run, a study nor a reproduction; name "
                          "one that optimize, compare or reproduce --out has made",
                          folder.string()));
}

std::optional<std::string> make_page_data(const std::filesystem::path& folder,
                                          const PageOptions& options, StopSignal& stop,
                                          RunObserver& observer) {
  switch (find_page_kind(folder)) {
    case PageKind::run:
      return make_run_page(folder, options, stop, observer);
    case PageKind::study:
      return make_study_page(folder, options, stop, observer);
    case PageKind::reproduction:
      break;
  }
  return make_reproduction_page(folder, options, stop, observer);
}

std::string get_page_title(std::string_view data) {
  return nlohmann::json::parse(data).at("title").get<std::string>();
}

}  // namespace armwright
