// Writes runs in the format of COCO's data archive, which cocopp reads.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "report/formats/export_files.hpp"
#include "report/formats/formats.hpp"

namespace armwright {
namespace {

constexpr std::size_t kMostProblems = 24;  // functions that the suite has
constexpr std::size_t kMostShown = 6;      // decision variables; with more of them, rows have none
constexpr double kPrecision = 1e-8;
constexpr int kLevelsPerDecade = 20;

// Returns the name of the dimension's data files without the ending.
std::string make_data_name(std::size_t id, std::size_t dimension) {
  return fmt::format("data_f{0}/bbobexp_f{0}_DIM{1}", id, dimension);
}

void write_function(const ProblemRuns& problem, const std::string& label, std::size_t id,
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
  write_output_file(
      root / fmt::format("bbobexp_f{}.info", id),
      fmt::format("suite = 'sbox-cost', funcId = {}, DIM = {}, Precision = {:.3e}, algId = '{}', "
                  "coco_version = '2.7.0', logger = 'bbob', data_format = 'bbob-new2', "
                  "settings = ''\n% {} on {}\n{}.dat{}\n",
                  id, dimension, kPrecision, root.filename().string(), sanitize(label),
                  sanitize(problem.name), name, summaries));
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

double calc_coco_infeasible(const ProblemRuns& problem) {
  double infeasible = 1e10;
  while (problem.worst && infeasible <= *problem.worst) {
    infeasible *= 10;
  }
  return infeasible;
}

CocoRun make_coco_run(const RunTrace& trace, const ProblemRuns& problem) {
  const double reference = problem.best.value_or(0);
  const double infeasible = calc_coco_infeasible(problem);
  CocoRun run;
  run.header = fmt::format(
      "% f evaluations | g evaluations | best noise-free fitness - Fref ({:.12e}) + sum g_i+ | "
      "measured fitness | best measured fitness or single-digit g-values | x1 | x2...\n",
      reference);
  std::optional<int> level;
  double best = infeasible;
  trace.evaluations.visit([&](const TracedEvaluation& evaluation) {
    const bool last = evaluation.number == trace.evaluations.last()->number;
    const double measured = evaluation.feasible ? *evaluation.objective : infeasible;
    best = std::min(best, measured);
    const int its_level = calc_coco_level(best - reference);
    const bool reaches = !level || its_level < *level;
    level = reaches ? its_level : level;
    const bool matches = is_coco_milestone(evaluation.number, trace.names.variables.size());
    if (!reaches && !matches && !last) {
      return;
    }
    std::vector<double> constraints = evaluation.constraint_values;
    constraints.resize(problem.constraints, HUGE_VAL);  // a failed evaluation satisfies none
    std::string row = fmt::format(
        "{} {} {:+.9e} {:+.9e} {}", evaluation.number, constraints.empty() ? 0 : evaluation.number,
        best - reference, measured,
        constraints.empty() ? fmt::format("{:+.9e}", best) : format_constraint_digits(constraints));
    for (std::size_t i = 0; i < evaluation.x.size() && evaluation.x.size() <= kMostShown; ++i) {
      row += fmt::format(" {:+.4e}", evaluation.x[i]);
    }
    row += '\n';
    run.dat += reaches || last ? row : "";
    run.tdat += matches || last ? row : "";
  });
  run.summary = fmt::format("{}:{}|{:.1e}", trace.run.replicate, trace.evaluations.last()->number,
                            best - reference);
  return run;
}

void write_coco(const CollectedRuns& collected, const std::filesystem::path& folder) {
  if (collected.problems.size() > kMostProblems) {
    throw Error(ErrorKind::usage,
                fmt::format("the format coco holds at most {} problems, and here are {}; use "
                            "another format, such as ioh",
                            kMostProblems, collected.problems.size()));
  }
  const auto labels = make_file_names(list_labels(collected));
  for (std::size_t i = 0; i < collected.problems.size(); ++i) {
    for (const auto& [label, runs] : collected.problems[i].labels) {
      write_function(collected.problems[i], label, i + 1, folder / labels.at(label));
    }
  }
}

}  // namespace armwright
