#include "report/reproduction/reproduction_config.hpp"

#include "base/config.hpp"
#include "problems/config/config_files.hpp"

namespace armwright {
namespace {

std::vector<std::string> get_strings_or_empty(const ConfigTable& table, std::string_view key) {
  return table.has(key) ? table.get_strings(key) : std::vector<std::string>{};
}

UnpublishedConfig read_unpublished(const ConfigTable& table) {
  UnpublishedConfig design{.label = table.get_string("label"),
                           .design = table.get_string("design"),
                           .problem = table.get_string("problem"),
                           .total_torque_n_m = {},
                           .where = table.get_string("where", "")};
  if (table.has("total_torque_n_m")) {
    design.total_torque_n_m =
        table.get_number("total_torque_n_m", Range{.lower = 0, .lower_open = true});
  }
  return design;
}

ResponseFigureConfig read_figure(const ConfigTable& table) {
  ResponseFigureConfig figure{.id = table.get_string("id"),
                              .title = table.get_string("title"),
                              .thesis = table.get_string("thesis"),
                              .remark = table.get_string("remark", ""),
                              .series = {}};
  for (const ConfigTable& series : table.get_tables("series")) {
    figure.series.push_back({series.get_string("name"), series.get_string("of")});
  }
  return figure;
}

}  // namespace

ReproductionConfig load_reproduction_config(const std::string& name_or_path) {
  constexpr std::int64_t kLargestSeed = 1'000'000'000;
  const ConfigTable table = ConfigTable::load(resolve_config("reproductions", name_or_path));
  ReproductionConfig config;
  config.title = table.get_string("title");
  config.remark = table.get_string("remark", "");
  config.optimizer = table.get_string("optimizer");
  config.seed = static_cast<std::uint64_t>(table.get_integer("seed", 0, kLargestSeed));
  config.engine = table.get_string("engine");
  for (const ConfigTable& run : table.get_tables_or_empty("runs")) {
    config.runs.push_back({run.get_string("label"), run.get_string("problem")});
  }
  for (const ConfigTable& design : table.get_tables_or_empty("unpublished")) {
    config.unpublished.push_back(read_unpublished(design));
  }
  config.sweep = table.get_string("sweep");
  for (const ConfigTable& again : table.get_tables_or_empty("reevaluation")) {
    config.reevaluations.push_back({again.get_string("label"), again.get_string("run"),
                                    get_strings_or_empty(again, "set"),
                                    again.get_string("where", "")});
  }
  for (const ConfigTable& figure : table.get_tables_or_empty("figure")) {
    config.figures.push_back(read_figure(figure));
  }
  for (const ConfigTable& replay : table.get_tables_or_empty("replay")) {
    config.replays.push_back({replay.get_string("id"), replay.get_string("title"),
                              replay.get_string("of"), get_strings_or_empty(replay, "beside"),
                              replay.get_string("training_case")});
  }
  for (const ConfigTable& momentary : table.get_tables_or_empty("momentary")) {
    config.momentary.push_back({momentary.get_string("name"), momentary.get_string("replay")});
  }
  table.refuse_unknown();
  return config;
}

}  // namespace armwright
