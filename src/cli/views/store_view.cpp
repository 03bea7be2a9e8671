#include "cli/views/store_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/text.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/table.hpp"

namespace armwright {
namespace {

using nlohmann::json;

std::string show(const std::filesystem::path& path) {
  return sanitize(path.string());
}

const char* name_kind(Finding::Kind kind) {
  switch (kind) {
    case Finding::Kind::note:
      return "note";
    case Finding::Kind::damage:
      return "DAMAGED";
    case Finding::Kind::loss:
      return "LOST";
  }
  return "?";
}

std::string quote(const std::vector<std::string>& words) {
  return words.empty() ? "" : sanitize(quote_command(words));
}

std::string make_repair_command(const StoreSurvey& survey, const std::string& program) {
  return quote({program, "doctor", survey.folder.string(), "--repair"});
}

std::string describe_journal(const RunSurvey& run) {
  if (!run.journal) {
    return "no readable record";
  }
  return fmt::format("{} and {} recorded in {}",
                     format_count(run.journal->evaluations.size(), "evaluation"),
                     format_count(run.journal->judgements, "judgement"),
                     format_count(run.journal->records, "intact record"));
}

std::string describe_writer(const std::string& writer) {
  return writer.empty() ? "" : fmt::format("; being written now by {}", writer);
}

// Adds the intact files of a run. They are shown only if the folder is that of a run.
void add_intact_files(const RunSurvey& run, Table& table) {
  const auto is_named = [&](const std::string& name) {
    return std::ranges::any_of(run.findings, [&](const Finding& finding) {
      return finding.file == name && finding.kind != Finding::Kind::note;
    });
  };
  if (!is_named("manifest.json")) {
    table.add_row({"intact", "manifest.json", "the configuration of the run"});
  }
  if (run.journal && !is_named("journal")) {
    table.add_row({"intact", "journal", describe_journal(run)});
  }
}

void add_findings(const std::vector<Finding>& findings, const std::filesystem::path& folder,
                  bool with_notes, Table& table) {
  for (const Finding& finding : findings) {
    if (with_notes || finding.kind != Finding::Kind::note) {
      const auto file = (folder / finding.file).lexically_normal();
      table.add_row({name_kind(finding.kind), show(file), sanitize(finding.what)});
    }
  }
}

Table make_table() {
  return Table({{"", false}, {"", false}, {"", false, true}});
}

struct Tally {
  std::size_t intact = 0, damaged = 0, unfinished = 0, written = 0;
  std::uint64_t evaluations = 0, lost = 0;
};

Tally count_runs(const StoreSurvey& survey) {
  Tally tally;
  for (const RunSurvey& run : survey.runs) {
    tally.damaged += run.is_damaged() ? 1 : 0;
    tally.intact += run.is_damaged() ? 0 : 1;
    tally.unfinished += run.state == RunSurvey::State::begun ? 1 : 0;
    tally.written += run.writer.empty() ? 0 : 1;
    tally.evaluations += run.journal ? run.journal->evaluations.size() : 0;
    tally.lost += run.lost;
  }
  return tally;
}

std::string describe_head(const StoreSurvey& survey, const Style& style) {
  const std::string folder = style.bold(show(survey.folder));
  if (survey.kind == StoreSurvey::Kind::run) {
    const RunSurvey& run = survey.runs.front();
    const bool has_lost_result =
        run.state == RunSurvey::State::begun && run.journal && run.journal->end;
    return fmt::format(
        "{}: a run, {}{}\n", folder,
        has_lost_result ? "ended, without a readable result.json" : to_string(run.state),
        describe_writer(survey.writer));
  }
  const Tally tally = count_runs(survey);
  std::string text =
      fmt::format("{}: a {}{}\n", folder, to_string(survey.kind), describe_writer(survey.writer));
  Table table({{"", false}, {"", true}});
  if (survey.planned_cells > 0) {
    table.add_row({"cells planned", std::to_string(survey.planned_cells)});
    table.add_row({"cells finished", std::to_string(survey.finished_cells)});
  }
  table.add_row({"runs intact", std::to_string(tally.intact)});
  table.add_row({"runs damaged", std::to_string(tally.damaged)});
  table.add_row({"runs unfinished", std::to_string(tally.unfinished)});
  if (tally.written > 0) {
    table.add_row({"runs being written", std::to_string(tally.written)});
  }
  table.add_row({"evaluations recorded", std::to_string(tally.evaluations)});
  if (tally.lost > 0) {
    table.add_row({"evaluations lost", std::to_string(tally.lost)});
  }
  return text + table.format(style, 2);
}

// Returns the commands that the user can try next, one per element.
std::vector<std::string> list_steps(const StoreSurvey& survey, const std::string& program) {
  if (survey.is_record_lost) {
    return {};
  }
  const bool is_unfinished = std::ranges::any_of(
      survey.runs, [](const RunSurvey& run) { return run.state != RunSurvey::State::finished; });
  if (survey.is_damaged()) {
    return {make_repair_command(survey, program),
            quote(make_command(survey, program, choose_repaired_folder(survey.folder)))};
  }
  if (survey.writer.empty() && (is_unfinished || survey.finished_cells < survey.planned_cells)) {
    return {quote(make_command(survey, program, survey.folder))};
  }
  return {};
}

json to_json(const std::vector<Finding>& findings) {
  json list = json::array();
  for (const Finding& finding : findings) {
    list.push_back({{"kind", finding.kind == Finding::Kind::note     ? "note"
                             : finding.kind == Finding::Kind::damage ? "damage"
                                                                     : "loss"},
                    {"file", show(finding.file)},
                    {"what", sanitize(finding.what)}});
  }
  return list;
}

json to_json(const std::vector<IndexRange>& ranges) {
  json list = json::array();
  for (const IndexRange& range : ranges) {
    list.push_back({range.first, range.last});
  }
  return list;
}

json to_json(const JournalSurvey& journal) {
  json damage = json::array();
  for (const DamagedStretch& stretch : journal.damage) {
    damage.push_back({{"offset", stretch.offset},
                      {"bytes", stretch.bytes},
                      {"record", stretch.records_before},
                      {"fault", stretch.fault},
                      {"records_before", stretch.records_before},
                      {"records_behind", stretch.records_behind}});
  }
  return {{"bytes", journal.bytes},
          {"records", journal.records},
          {"evaluations", journal.evaluations.size()},
          {"judgements", journal.judgements},
          {"damage", damage},
          {"torn", {{"offset", journal.torn_offset}, {"bytes", journal.torn_bytes}}},
          {"lost", to_json(journal.list_lost())},
          {"gaps", to_json(journal.list_gaps())},
          {"contradictory", journal.contradictory},
          {"ended", journal.end.has_value()}};
}

json to_json(const RunSurvey& run) {
  return {{"name", show(run.name)},
          {"state", to_string(run.state)},
          {"damaged", run.is_damaged()},
          {"writer", run.writer},
          {"lost_evaluations", run.lost},
          {"journal", run.journal ? to_json(*run.journal) : json(nullptr)},
          {"findings", to_json(run.findings)}};
}

std::string describe_kept(const RunRepair& run) {
  if (run.is_set_aside) {
    return fmt::format("its manifest.json is lost: the run begins again ({})",
                       format_count(run.evaluations_lost, "evaluation"));
  }
  std::string text =
      fmt::format("{} kept, {} to be made again", format_count(run.evaluations_kept, "evaluation"),
                  run.evaluations_lost);
  if (run.has_new_journal) {
    text += fmt::format("; journal: {} kept, {} and {} dropped",
                        format_count(run.journal.records_kept, "record"),
                        format_count(run.journal.records_dropped, "record"),
                        format_count(run.journal.bytes_dropped, "damaged byte"));
  }
  if (!run.made_again.empty()) {
    text += "; left out, as it is made again: " + join(run.made_again, ", ");
  }
  if (!run.kept_aside.empty()) {
    text += "; kept as NAME.damaged: " + sanitize(join(run.kept_aside, ", "));
  }
  return text;
}

}  // namespace

std::filesystem::path choose_repaired_folder(const std::filesystem::path& folder) {
  auto path = folder.lexically_normal();
  if (!path.has_filename()) {
    path = path.parent_path();  // "results/mine/"
  }
  if (path == "." || path == "..") {
    path = std::filesystem::absolute(path).lexically_normal();
    path = path.has_filename() ? path : path.parent_path();
  }
  return path.string() + ".repaired";
}

std::string describe_survey(const StoreSurvey& survey, const std::string& program,
                            const Style& style) {
  const bool is_run = survey.kind == StoreSurvey::Kind::run;
  Table table = make_table();
  bool has_rows = !survey.findings.empty();
  add_findings(survey.findings, ".", true, table);
  for (const RunSurvey& run : survey.runs) {
    if (is_run) {
      add_intact_files(run, table);
    }
    add_findings(run.findings, run.name, is_run, table);
    has_rows = has_rows || is_run || run.is_damaged();
  }
  std::string text = describe_head(survey, style);
  if (has_rows) {
    text += (is_run ? "" : "\n") + table.format(style, 2, get_text_width(Stream::out));
  }
  text += survey.is_damaged() ? "" : "All stored files are intact.\n";
  if (survey.is_record_lost) {
    for (const std::string& line :
         wrap_words(advise_on_lost_record(survey, program), get_text_width(Stream::out))) {
      text += line + "\n";
    }
  }
  const auto steps = list_steps(survey, program);
  if (!steps.empty()) {
    text +=
        survey.is_damaged() ? "To resume from the intact records, in a copy:\n" : "To resume:\n";
    for (const std::string& step : steps) {
      text += step.empty() ? "  the command that began it, with --out FOLDER for the copy\n"
                           : fmt::format("  {}\n", step);
    }
  }
  return text;
}

json to_json(const StoreSurvey& survey, const std::string& program) {
  json runs = json::array();
  for (const RunSurvey& run : survey.runs) {
    runs.push_back(to_json(run));
  }
  json result = {{"folder", show(survey.folder)},
                 {"kind", to_string(survey.kind)},
                 {"damaged", survey.is_damaged()},
                 {"repairable", !survey.is_record_lost},
                 {"writer", survey.writer},
                 {"findings", to_json(survey.findings)},
                 {"runs", runs},
                 {"steps", list_steps(survey, program)}};
  if (survey.kind == StoreSurvey::Kind::study) {
    result["cells"] = {{"planned", survey.planned_cells}, {"finished", survey.finished_cells}};
  }
  return result;
}

std::string describe_repair(const StoreRepair& repair, const StoreSurvey& copy,
                            const std::string& program) {
  std::string text = fmt::format("{}: the repaired copy\n", show(repair.copy));
  Table table({{"", false}, {"", false, true}});
  for (const RunRepair& run : repair.runs) {
    table.add_row({run.name == "." ? "" : show(run.name), describe_kept(run)});
  }
  for (const auto& file : repair.kept_aside) {
    table.add_row({show(file), "damaged, kept as NAME.damaged; it will be made again"});
  }
  for (const auto& file : repair.left_out) {
    table.add_row({show(file), "neither a file nor a folder; not copied"});
  }
  text += table.format(Style(false), 2, get_text_width(Stream::out));
  const std::string command = quote(make_command(copy, program, repair.copy));
  return text + (command.empty()
                     ? "To resume: the command that began it, with --out FOLDER for the copy\n"
                     : fmt::format("To resume:\n  {}\n", command));
}

json to_json(const StoreRepair& repair, const StoreSurvey& copy, const std::string& program) {
  json runs = json::array();
  for (const RunRepair& run : repair.runs) {
    runs.push_back({{"name", show(run.name)},
                    {"made_anew", run.is_set_aside},
                    {"evaluations_kept", run.evaluations_kept},
                    {"evaluations_lost", run.evaluations_lost},
                    {"records_kept", run.journal.records_kept},
                    {"records_dropped", run.journal.records_dropped},
                    {"bytes_dropped", run.journal.bytes_dropped},
                    {"kept_aside", run.kept_aside},
                    {"made_again", run.made_again}});
  }
  json aside = json::array();
  for (const auto& file : repair.kept_aside) {
    aside.push_back(show(file));
  }
  return {{"copy", show(repair.copy)},
          {"runs", runs},
          {"kept_aside", aside},
          {"command", quote(make_command(copy, program, repair.copy))}};
}

}  // namespace armwright
