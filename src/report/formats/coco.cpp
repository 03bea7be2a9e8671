#include "report/formats/coco.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "report/formats/export_folder.hpp"
#include "report/formats/export_names.hpp"

namespace armwright {
namespace {

constexpr std::size_t kMostProblems = 24;  // functions that the suite has
constexpr std::size_t kMostShown = 6;      // decision variables; of more, rows bear none
constexpr double kPrecision = 1e-8;
constexpr int kLevelsPerDecade = 20;

// The dimension's data files: the name without its ending.
std::string make_data_name(std::size_t id, std::size_t dimension) {
  return fmt::format("data_f{0}/bbobexp_f{0}_DIM{1}", id, dimension);
}

void write_function(const ProblemRuns& problem, const LabelRuns& label, std::size_t id,
                    const std::filesystem::path& root) {
  const std::size_t dimension = problem.names.variables.size();
  const CocoScale scale = make_coco_scale(problem);
  const std::string name = make_data_name(id, dimension);
  OutputFile dat(root / (name + ".dat"));
  OutputFile tdat(root / (name + ".tdat"));
  OutputFile rdat(root / (name + ".rdat"));
  OutputFile mdat(root / (name + ".mdat"));
  std::string summaries;
  for (const RunEntry& run : label.runs) {
    const CocoRun rows = make_coco_run(read_trace(run), scale);
    dat.write(rows.header + rows.dat);
    tdat.write(rows.header + rows.tdat);
    rdat.write(rows.header);
    mdat.write(rows.header);
    summaries += ", " + rows.summary;
  }
  for (OutputFile* file : {&dat, &tdat, &rdat, &mdat}) {
    file->close();
  }
  // Quotes, commas and line breaks would end the fields of the first line, so the algorithm goes by
  // the name of its folder there; the comment has both true names.
  write_output_file(
      root / fmt::format("bbobexp_f{}.info", id),
      fmt::format("suite = 'sbox-cost', funcId = {}, DIM = {}, Precision = {:.3e}, algId = '{}', "
                  "coco_version = '2.7.0', logger = 'bbob', data_format = 'bbob-new2', "
                  "settings = ''\n% {} on {}\n{}.dat{}\n",
                  id, dimension, kPrecision, root.filename().string(), sanitize(label.label),
                  sanitize(problem.name), name, summaries));
}

}  // namespace

bool LevelTrigger::reaches(double difference) {
  const int level =
      static_cast<int>(std::ceil(kLevelsPerDecade * std::log10(std::max(difference, kPrecision))));
  if (level_ && level >= *level_) {
    return false;
  }
  level_ = level;
  return true;
}

bool EvaluationTrigger::matches(std::uint64_t evaluation) {
  const auto calc_next = [this] {
    return static_cast<std::uint64_t>(std::pow(10.0, static_cast<double>(power_) / 20));
  };
  while (calc_next() < evaluation) {
    ++power_;
  }
  if (calc_next() == evaluation) {
    return true;
  }
  std::uint64_t multiple = evaluation % dimension_ == 0 ? evaluation / dimension_ : 0;
  while (multiple > 0 && multiple % 10 == 0) {
    multiple /= 10;
  }
  return multiple == 1 || multiple == 2 || multiple == 5;
}

std::string format_constraint_digits(std::span<const double> constraint_values) {
  // The upper ends of the classes 0 to 8.
  static constexpr double ends[] = {0, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1};
  std::string digits;
  for (const double g : constraint_values) {
    const auto end = std::lower_bound(std::begin(ends), std::end(ends), g);
    digits += static_cast<char>('0' + (end - std::begin(ends)));
  }
  return digits;
}

CocoScale make_coco_scale(const ProblemRuns& problem) {
  CocoScale scale;
  scale.constraints = problem.constraints;
  if (problem.best) {
    scale.reference = *problem.best;
    while (scale.infeasible <= *problem.worst) {
      scale.infeasible *= 10;
    }
  }
  return scale;
}

CocoRun make_coco_run(const RunTrace& trace, const CocoScale& scale) {
  CocoRun run;
  run.header = fmt::format(
      "% f evaluations | g evaluations | best noise-free fitness - Fref ({:.12e}) + sum g_i+ | "
      "measured fitness | best measured fitness or single-digit g-values | x1 | x2...\n",
      scale.reference);
  LevelTrigger level;
  EvaluationTrigger number(trace.names.variables.size());
  double best = scale.infeasible;
  trace.evaluations.visit([&](const TracedEvaluation& evaluation) {
    const bool last = evaluation.number == trace.evaluations.last()->number;
    const double measured = evaluation.feasible ? *evaluation.objective : scale.infeasible;
    best = std::min(best, measured);
    const bool reaches = level.reaches(best - scale.reference);
    const bool matches = number.matches(evaluation.number);
    if (!reaches && !matches && !last) {
      return;
    }
    std::vector<double> constraints = evaluation.constraint_values;
    constraints.resize(scale.constraints, HUGE_VAL);  // a failed one has none: none is met
    std::string row = fmt::format(
        "{} {} {:+.9e} {:+.9e} {}", evaluation.number, constraints.empty() ? 0 : evaluation.number,
        best - scale.reference, measured,
        constraints.empty() ? fmt::format("{:+.9e}", best) : format_constraint_digits(constraints));
    for (std::size_t i = 0; i < evaluation.x.size() && evaluation.x.size() <= kMostShown; ++i) {
      row += fmt::format(" {:+.4e}", evaluation.x[i]);
    }
    row += '\n';
    run.dat += reaches || last ? row : "";
    run.tdat += matches || last ? row : "";
  });
  run.summary = fmt::format("{}:{}|{:.1e}", trace.run.replicate, trace.evaluations.last()->number,
                            best - scale.reference);
  return run;
}

void write_coco(const Survey& survey, const std::filesystem::path& folder) {
  if (survey.problems.size() > kMostProblems) {
    throw Error(ErrorKind::usage,
                fmt::format("the format coco holds at most {} problems, and here are {}; use "
                            "another format, such as ioh",
                            kMostProblems, survey.problems.size()));
  }
  const auto labels = make_file_names(list_labels(survey));
  for (std::size_t i = 0; i < survey.problems.size(); ++i) {
    for (const LabelRuns& label : survey.problems[i].labels) {
      write_function(survey.problems[i], label, i + 1, folder / labels.at(label.label));
    }
  }
}

}  // namespace armwright
