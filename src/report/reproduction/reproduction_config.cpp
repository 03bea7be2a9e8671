#include "report/reproduction/reproduction_config.hpp"

#include "base/config.hpp"
#include "problems/config/config_files.hpp"

namespace armwright {
namespace {

std::vector<std::string> get_strings_or_empty(const ConfigTable& table, std::string_view key) {
  return table.has(key) ? table.get_strings(key) : std::vector<std::string>{};
}

ReproductionPart read_run(const ConfigTable& table) {
  ReproductionPart part;
  part.kind = ReproductionPart::Kind::anew;
  part.label = table.get_string("label");
  part.problem = table.get_string("problem");
  return part;
}

ReproductionPart read_unpublished(const ConfigTable& table) {
  ReproductionPart part;
  part.kind = ReproductionPart::Kind::unpublished;
  part.label = table.get_string("label");
  part.design = table.get_string("design");
  part.problem = table.get_string("problem");
  part.where = table.get_string("where", "");
  if (table.has("total_torque_n_m")) {
    part.published_torque_n_m =
        table.get_number("total_torque_n_m", Range{.lower = 0, .lower_open = true});
  }
  return part;
}

ReproductionPart read_reevaluation(const ConfigTable& table) {
  ReproductionPart part;
  part.kind = ReproductionPart::Kind::anew;
  part.label = table.get_string("label");
  part.run = table.get_string("run");
  part.overrides = get_strings_or_empty(table, "set");
  part.where = table.get_string("where", "");
  return part;
}

ResponseFigureConfig read_figure(const ConfigTable& table) {
  ResponseFigureConfig figure{.id = table.get_string("id"),
                              .title = table.get_string("title"),
                              .thesis = table.get_string("thesis"),
                              .remark = table.get_string("remark", ""),
                              .series = {}};
  for (const ConfigTable& series : table.get_tables("series")) {
    figure.series.emplace_back(series.get_string("name"), series.get_string("of"));
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
    config.runs.push_back(read_run(run));
  }
  for (const ConfigTable& design : table.get_tables_or_empty("unpublished")) {
    config.unpublished.push_back(read_unpublished(design));
  }
  config.sweep = table.get_string("sweep");
  for (const ConfigTable& again : table.get_tables_or_empty("reevaluation")) {
    config.reevaluations.push_back(read_reevaluation(again));
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
    config.momentary.emplace_back(momentary.get_string("name"), momentary.get_string("replay"));
  }
  table.refuse_unknown();
  return config;
}

}  // namespace armwright
