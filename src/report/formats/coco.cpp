// Writes runs in the format of COCO's data archive, which cocopp reads.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "report/formats/export_files.hpp"
#include "report/formats/export_functions.hpp"
#include "report/formats/formats.hpp"

namespace armwright {
namespace {

constexpr std::size_t kMostShown = 6;  // decision variables; with more of them, rows have none
constexpr double kPrecision = 1e-8;
constexpr int kLevelsPerDecade = 20;

// Returns the name of the dimension's data files without the ending.
std::string make_data_name(std::size_t id, std::size_t dimension) {
  return fmt::format("data_f{0}/bbobexp_f{0}_DIM{1}", id, dimension);
}

// Returns the second line of a block, which names the problem and the source of the reference.
std::string make_comment(const ProblemRuns& problem, const std::string& label) {
  std::string reference = "no exported run is feasible, so Fref is 0";
  if (problem.function.optimum) {
    reference = "Fopt is the known smallest value";
  } else if (problem.best) {
    reference =
        fmt::format("Fref is the best feasible value of the exported runs, of '{}', replicate {}",
                    sanitize(problem.best_run.label), problem.best_run.replicate);
  }
  for (const auto& [variable, choices] : problem.names.discrete) {
    for (std::size_t i = 0; i < choices.size(); ++i) {
      reference += fmt::format("{} {} = '{}'", i == 0 ? "; " + sanitize(variable) + ":" : ",", i,
                               sanitize(choices[i]));
    }
  }
  return fmt::format("% {} on {}; {}\n", sanitize(label), sanitize(problem.name), reference);
}

// Writes the data files of one label on one problem. Returns the three lines of its block in the
// function's .info file.
std::string write_block(const ProblemRuns& problem, const std::string& label, std::size_t id,
                        const std::filesystem::path& root) {
  const std::size_t dimension = problem.names.variables.size();
  const std::string name = make_data_name(id, dimension);
  OutputFile dat(root / (name + ".dat"));
  OutputFile tdat(root / (name + ".tdat"));
  OutputFile rdat(root / (name + ".rdat"));
  OutputFile mdat(root / (name + ".mdat"));
  std::string summaries;
  for (const RunEntry& run : problem.labels.at(label)) {
    const CocoRun rows = make_coco_run(read_trace(run), problem);
    dat.write(rows.header + rows.dat);
    tdat.write(rows.header + rows.tdat);
    rdat.write(rows.header);
    mdat.write(rows.header);
    summaries += ", " + rows.summary;
  }
  for (OutputFile* file : {&dat, &tdat, &rdat, &mdat}) {
    file->close();
  }
  // Quotes, commas and line breaks would end the fields of the first line. Therefore the first line
  // has the name of the label's folder, and the comment has both true names.
  return fmt::format(
      "suite = '{}', funcId = {}, DIM = {}, Precision = {:.3e}, algId = '{}', "
      "coco_version = '2.7.0', logger = 'bbob', data_format = 'bbob-new2'\n{}{}.dat{}\n",
      kCocoSuite, id, dimension, kPrecision, root.filename().string(), make_comment(problem, label),
      name, summaries);
}

}  // namespace

int calc_coco_level(double difference) {
  return static_cast<int>(
      std::ceil(kLevelsPerDecade * std::log10(std::max(difference, kPrecision))));
}

bool is_coco_milestone(std::uint64_t evaluation, std::size_t dimension) {
  const auto calc_power = [](int k) {
    return static_cast<std::uint64_t>(std::pow(10.0, static_cast<double>(k) / 20));
  };
  // Starts one below the rounded logarithm, so that no rounding can skip the least k.
  int k = std::max(0, static_cast<int>(20 * std::log10(static_cast<double>(evaluation))) - 1);
  while (calc_power(k) < evaluation) {
    ++k;
  }
  if (calc_power(k) == evaluation) {
    return true;
  }
  std::uint64_t multiple = evaluation % dimension == 0 ? evaluation / dimension : 0;
  while (multiple > 0 && multiple % 10 == 0) {
    multiple /= 10;
  }
  return multiple == 1 || multiple == 2 || multiple == 5;
}

std::string format_constraint_digits(std::span<const double> constraint_values) {
  // The upper ends of the classes of digits 0 to 8.
  static constexpr double ends[] = {0, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1};
  std::string digits;
  for (const double g : constraint_values) {
    const auto end = std::lower_bound(std::begin(ends), std::end(ends), g);
    digits += static_cast<char>('0' + (end - std::begin(ends)));
  }
  return digits;
}

double calc_coco_difference(double best, double reference) {
  return std::max(0.0, best - reference);
}

double calc_coco_infeasible(const ProblemRuns& problem) {
  double infeasible = 1e10;
  while (problem.worst && infeasible <= *problem.worst) {
    infeasible *= 10;
  }
  return infeasible;
}

CocoRun make_coco_run(const RunTrace& trace, const ProblemRuns& problem) {
  const std::optional<double>& optimum = trace.function.optimum;
  const double reference = optimum ? *optimum : problem.best.value_or(0);
  const double infeasible = calc_coco_infeasible(problem);
  CocoRun run;
  run.header = fmt::format(
      "% f evaluations | g evaluations | best noise-free fitness - {} ({:.12e}) + sum g_i+ | "
      "measured fitness | best measured fitness or single-digit g-values | x1 | x2...\n",
      optimum ? "Fopt" : "Fref", reference);
  std::optional<int> level;
  double best = infeasible;
  trace.evaluations.visit([&](const TracedEvaluation& evaluation) {
    const bool last = evaluation.number == trace.evaluations.last()->number;
    const double measured = evaluation.feasible ? *evaluation.objective : infeasible;
    best = std::min(best, measured);
    const double difference = calc_coco_difference(best, reference);
    const int its_level = calc_coco_level(difference);
    const bool reaches = !level || its_level < *level;
    level = reaches ? its_level : level;
    const bool matches = is_coco_milestone(evaluation.number, trace.names.variables.size());
    if (!reaches && !matches && !last) {
      return;
    }
    std::vector<double> constraints = evaluation.constraint_values;
    constraints.resize(problem.constraints, HUGE_VAL);  // a failed evaluation satisfies none
    std::string row = fmt::format(
        "{} 0 {:+.9e} {:+.9e} {}", evaluation.number, difference, measured,
        constraints.empty() ? fmt::format("{:+.9e}", best) : format_constraint_digits(constraints));
    for (std::size_t i = 0; i < evaluation.x.size() && evaluation.x.size() <= kMostShown; ++i) {
      row += fmt::format(" {:+.4e}", evaluation.x[i]);
    }
    row += '\n';
    run.dat += reaches || last ? row : "";
    run.tdat += matches || last ? row : "";
  });
  run.summary = fmt::format("{}:{}|{:.1e}", trace.run.replicate, trace.evaluations.last()->number,
                            calc_coco_difference(best, reference));
  return run;
}

void write_coco(const CollectedRuns& collected, const std::filesystem::path& folder) {
  const std::vector<ExportFunction> functions = number_functions(collected);
  if (functions.back().id > kLastCocoFunction) {
    throw Error(ErrorKind::usage,
                fmt::format("the format coco holds at most {} functions that are not shipped "
                            "problems with their own settings, and here are {}; use another "
                            "format, such as ioh",
                            kLastCocoFunction - kFirstOwnFunction + 1,
                            functions.back().id - kFirstOwnFunction + 1));
  }
  for (const auto& [label, root] : make_file_names(list_labels(collected))) {
    for (const ExportFunction& function : functions) {
      std::string blocks;
      for (const ProblemRuns* problem : function.problems) {
        if (problem->labels.contains(label)) {
          blocks += write_block(*problem, label, function.id, folder / root);
        }
      }
      if (!blocks.empty()) {
        write_output_file(folder / root / fmt::format("bbobexp_f{}.info", function.id), blocks);
      }
    }
  }
  write_output_file(folder / kCocoScript, make_coco_script(functions));
}

}  // namespace armwright
