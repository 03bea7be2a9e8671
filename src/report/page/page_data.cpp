#include "report/page/page_data.hpp"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/file.hpp"
#include "report/page/page_file.hpp"
#include "report/page/reproduction_page.hpp"
#include "report/page/run_page.hpp"
#include "report/page/study_page.hpp"
#include "report/reproduction/reproduction_record.hpp"
#include "study/compare/study_folder.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr std::size_t kPageLimit_bytes = std::size_t{1} << 30;

}  // namespace

std::optional<std::string> make_page_data(const std::filesystem::path& folder,
                                          const PageOptions& options, StopSignal& stop,
                                          RunObserver& observer) {
  if (!std::filesystem::exists(folder)) {
    throw Error(ErrorKind::usage, fmt::format("{}: there is no such folder", folder.string()));
  }
  if (is_study_folder(folder)) {
    return make_study_page(folder, options, stop, observer);
  }
  if (is_reproduction_folder(folder)) {
    return make_reproduction_page(folder, options, stop, observer);
  }
  if (std::filesystem::exists(folder / "manifest.json")) {
    return make_run_page(folder, options, stop, observer);
  }
  throw Error(
      ErrorKind::usage,
      fmt::format("{}: is the folder of neither a run, a comparison nor a reproduction; name "
                  "one that optimize, compare or reproduce --out has made",
                  folder.string()));
}

bool is_page_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string beginning(1024, '\0');
  stream.read(beginning.data(), static_cast<std::streamsize>(beginning.size()));
  beginning.resize(static_cast<std::size_t>(stream.gcount()));
  return beginning.find(kPageMark) != std::string::npos;
}

std::string read_page_data(const std::filesystem::path& page) {
  const std::string html = read_file(page, kPageLimit_bytes);
  const std::size_t block = html.find(kPageDataBegin);
  const std::size_t begin = block + std::string_view(kPageDataBegin).size();
  const std::size_t end = block == std::string::npos ? block : html.find("</script>", begin);
  if (!is_page_file(page) || end == std::string::npos) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: is no page that armwright report wrote", page.string()));
  }
  return html.substr(begin, end - begin);
}

std::string get_page_title(std::string_view data) {
  return json::parse(data).at("title").get<std::string>();
}

}  // namespace armwright
