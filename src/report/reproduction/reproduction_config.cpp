#include "report/reproduction/reproduction_config.hpp"

#include "base/config.hpp"
#include "problems/config/config_files.hpp"

namespace armwright {
namespace {

// These files are not on the page of settings, so that the declarations have no meanings. The
// header explains what the values are for.
const Setting<std::string> kReproLabel("label", kNoDefault, "");
const Setting<std::string> kReproDesign("design", kNoDefault, "");
const Setting<std::string> kReproProblem("problem", kNoDefault, "");
const Setting<std::string> kReproId("id", kNoDefault, "");
const Setting<std::string> kReproTitle("title", kNoDefault, "");
const Setting<std::string> kReproThesis("thesis", kNoDefault, "");
const Setting<std::string> kReproName("name", kNoDefault, "");
const Setting<std::string> kReproOf("of", kNoDefault, "");
const Setting<std::string> kReproOptimizer("optimizer", kNoDefault, "");
const Setting<std::string> kReproEngine("engine", kNoDefault, "");
const Setting<std::string> kReproSweep("sweep", kNoDefault, "");
const Setting<std::string> kReproRun("run", kNoDefault, "");
const Setting<std::string> kReproReplay("replay", kNoDefault, "");
const Setting<std::string> kReproTrainingCase("training_case", kNoDefault, "");
const Setting<std::string> kReproRemark("remark", "", "");
const Setting<std::string> kReproWhere("where", "", "");
const Setting<std::vector<std::string>> kReproSet("set", kNoDefault, "");
const Setting<std::vector<std::string>> kReproParts("parts", kNoDefault, "");
const Setting<std::string> kReproReason("reason", kNoDefault, "");
const Setting<std::vector<std::string>> kReproBeside("beside", kNoDefault, "");
const Setting<std::int64_t> kReproSeed("seed", {.lower = 0, .upper = 1e9}, kNoDefault, "");
const Setting<double> kReproTorque("total_torque_n_m", {.lower = 0, .lower_open = true}, kNoDefault,
                                   "");
const SettingTable kReproSeriesTable{.key = "series", .is_array = true};
const SettingTable kReproRunsTable{.key = "runs", .is_array = true};
const SettingTable kReproUnpublishedTable{.key = "unpublished", .is_array = true};
const SettingTable kReproReevaluationTable{.key = "reevaluation", .is_array = true};
const SettingTable kReproFigureTable{.key = "figure", .is_array = true};
const SettingTable kReproDifferenceTable{.key = "difference", .is_array = true};
const SettingTable kReproReplayTable{.key = "replay", .is_array = true};
const SettingTable kReproMomentaryTable{.key = "momentary", .is_array = true};

ReproductionPart read_run(const ConfigTable& table) {
  ReproductionPart part;
  part.kind = ReproductionPart::Kind::anew;
  part.label = table.get(kReproLabel);
  part.problem = table.get(kReproProblem);
  return part;
}

ReproductionPart read_unpublished(const ConfigTable& table) {
  ReproductionPart part;
  part.kind = ReproductionPart::Kind::unpublished;
  part.label = table.get(kReproLabel);
  part.design = table.get(kReproDesign);
  part.problem = table.get(kReproProblem);
  part.where = table.get(kReproWhere);
  part.published_torque_n_m = table.find(kReproTorque);
  return part;
}

ReproductionPart read_reevaluation(const ConfigTable& table) {
  ReproductionPart part;
  part.kind = ReproductionPart::Kind::anew;
  part.label = table.get(kReproLabel);
  part.run = table.get(kReproRun);
  part.overrides = table.get_or(kReproSet, {});
  part.where = table.get(kReproWhere);
  return part;
}

ResponseFigureConfig read_figure(const ConfigTable& table) {
  ResponseFigureConfig figure{.id = table.get(kReproId),
                              .title = table.get(kReproTitle),
                              .thesis = table.get(kReproThesis),
                              .remark = table.get(kReproRemark),
                              .series = {}};
  for (const ConfigTable& series : table.get_tables(kReproSeriesTable)) {
    figure.series.emplace_back(series.get(kReproName), series.get(kReproOf));
  }
  return figure;
}

}  // namespace

ReproductionConfig load_reproduction_config(const std::string& name_or_path) {
  const ConfigTable table = ConfigTable::load(resolve_config("reproductions", name_or_path));
  ReproductionConfig config;
  config.title = table.get(kReproTitle);
  config.remark = table.get(kReproRemark);
  config.optimizer = table.get(kReproOptimizer);
  config.seed = static_cast<std::uint64_t>(table.get(kReproSeed));
  config.engine = table.get(kReproEngine);
  config.overrides = table.get_or(kReproSet, {});
  for (const ConfigTable& run : table.get_tables_or_empty(kReproRunsTable)) {
    config.runs.push_back(read_run(run));
    config.runs.back().overrides = config.overrides;
  }
  for (const ConfigTable& design : table.get_tables_or_empty(kReproUnpublishedTable)) {
    config.unpublished.push_back(read_unpublished(design));
    config.unpublished.back().overrides = config.overrides;
  }
  config.sweep = table.get(kReproSweep);
  for (const ConfigTable& again : table.get_tables_or_empty(kReproReevaluationTable)) {
    config.reevaluations.push_back(read_reevaluation(again));
    std::vector<std::string>& overrides = config.reevaluations.back().overrides;
    overrides.insert(overrides.begin(), config.overrides.begin(), config.overrides.end());
  }
  for (const ConfigTable& figure : table.get_tables_or_empty(kReproFigureTable)) {
    config.figures.push_back(read_figure(figure));
  }
  for (const ConfigTable& difference : table.get_tables_or_empty(kReproDifferenceTable)) {
    for (const std::string& label : difference.get(kReproParts)) {
      config.reasons[label] = difference.get(kReproReason);
    }
  }
  for (const ConfigTable& replay : table.get_tables_or_empty(kReproReplayTable)) {
    config.replays.push_back({replay.get(kReproId), replay.get(kReproTitle), replay.get(kReproOf),
                              replay.get_or(kReproBeside, {}), replay.get(kReproTrainingCase)});
  }
  for (const ConfigTable& momentary : table.get_tables_or_empty(kReproMomentaryTable)) {
    config.momentary.emplace_back(momentary.get(kReproName), momentary.get(kReproReplay));
  }
  table.refuse_unknown();
  return config;
}

}  // namespace armwright
