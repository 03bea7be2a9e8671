// Writes the shell script that runs the cells of a submission.

#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "study/compare/plugin_consent.hpp"
#include "study/compare/study_folder.hpp"
#include "study/matrix/cell_selection.hpp"
#include "study/matrix/chunks.hpp"

namespace armwright {
namespace {

constexpr const char* kScriptHead = R"(#!/usr/bin/env bash
# {cells} cells of the study '{name}' (plan {hash}) in {chunks} chunks, written by armwright.
#
#   bash run.sh                                      all chunks, one after the other
#   bash run.sh 7                                    chunk 7 only
#   seq {chunks} | parallel -j 8 bash run.sh {{}}          GNU parallel, eight at a time
#   sbatch --array=1-{chunks} --requeue run.sh            Slurm
#   qsub -J 1-{chunks} -r y run.sh                        PBS Pro, OpenPBS
#   qsub -t 1-{chunks} -r y run.sh                        Torque, Grid Engine (there with -S /bin/bash)
#
# Cells that are done are skipped and others go on where they were, so that any of it may be repeated,
# also while it runs. When all chunks have ended:
#   {merge}
set -u

cd {folder} || exit 74
{configs}armwright={program}
study={study}
chunks={chunks}

run_cells() {{ "$armwright" cell --jobs {jobs}{trust} "$study" "$@"; }}

run_chunk() {{
  case "$1" in
)";

constexpr const char* kScriptTail = R"(    *)
      echo "run.sh: there is no chunk '$1'; the chunks are 1 to $chunks" >&2
      return 2
      ;;
  esac
}

# Grid Engine says "undefined" outside of arrays.
chunk=${1:-${SLURM_ARRAY_TASK_ID:-${PBS_ARRAY_INDEX:-${PBS_ARRAYID:-${SGE_TASK_ID:-}}}}}
if [[ -n "$chunk" && "$chunk" != undefined ]]; then
  # In this process's place: signals of the batch system reach the program itself.
  run_cells() { exec "$armwright" cell --jobs @JOBS@@TRUST@ "$study" "$@"; }
  run_chunk "$chunk"
  exit
fi

worst=0
for ((chunk = 1; chunk <= chunks; ++chunk)); do
  run_chunk "$chunk"
  code=$?
  if ((code == 3)); then  # a cell has failed; the others do not care
    worst=3
  elif ((code != 0)); then
    exit "$code"
  fi
done
echo "run.sh: all chunks have ended. Statistics, tables and verdict:" >&2
echo "  @MERGE@" >&2
exit "$worst"
)";

std::string quote_word(const std::string& word) {
  return quote_command(std::vector<std::string>{word});
}

void replace_word(std::string& text, std::string_view word, const std::string& by) {
  for (std::size_t at = text.find(word); at != std::string::npos;
       at = text.find(word, at + by.size())) {
    text.replace(at, word.size(), by);
  }
}

// Escapes a text for use inside double quotes in bash.
std::string escape_for_echo(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (std::string_view("\\\"$`").find(c) != std::string_view::npos) {
      escaped += '\\';
    }
    escaped += c;
  }
  return escaped;
}

}  // namespace

std::string make_cell_script(const StudyPlan& plan, std::span<const Chunk> chunks,
                             const CellScriptRequest& request) {
  std::size_t cells = 0;
  for (const Chunk& chunk : chunks) {
    cells += chunk.cells.size();
  }
  const std::string merge = quote_command(
      std::vector<std::string>{request.program.string(), "merge", request.study.string()});
  const std::string configs =
      request.configs ? fmt::format("export ARMWRIGHT_CONFIGS={}\n", quote_word(*request.configs))
                      : "";
  // The jobs inherit the consent to run plugins.
  const bool has_plugins = !list_programs(plan.problems).empty() ||
                           std::ranges::any_of(plan.optimizers, [](const StudyOptimizer& one) {
                             return is_plugin(one.name);
                           });
  const std::string trust = has_plugins ? " --trust" : "";
  // Texts in comments and messages must not end them.
  std::string text = fmt::format(
      fmt::runtime(kScriptHead), fmt::arg("cells", cells), fmt::arg("name", sanitize(plan.name)),
      fmt::arg("hash", calc_plan_hash(plan).substr(0, 16)), fmt::arg("chunks", chunks.size()),
      fmt::arg("merge", sanitize(merge)), fmt::arg("folder", quote_word(request.folder.string())),
      fmt::arg("configs", configs), fmt::arg("program", quote_word(request.program.string())),
      fmt::arg("study", quote_word(request.study.string())), fmt::arg("jobs", request.jobs),
      fmt::arg("trust", trust));
  for (std::size_t number = 0; number < chunks.size(); ++number) {
    text += fmt::format("    {}) run_cells", number + 1);
    for (const Cell& cell : chunks[number].cells) {
      // The name needs no quotes: it has only letters, digits and _ - . % /.
      text += " " + make_cell_name(plan, cell);
    }
    text += " ;;\n";
  }
  std::string tail = kScriptTail;
  replace_word(tail, "@JOBS@", std::to_string(request.jobs));
  replace_word(tail, "@TRUST@", trust);
  replace_word(tail, "@MERGE@", escape_for_echo(sanitize(merge)));
  return text + tail;
}

}  // namespace armwright
