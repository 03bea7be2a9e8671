// result.json, check.json, cell.json, attempt.json and SHA256SUMS: what is read is the same written and read
// again.
#include "base/folder_checksums.hpp"
#include "fuzz/harness.hpp"
#include "study/compare/cell.hpp"
#include "study/matrix/attempt.hpp"
#include "study/run/run_result.hpp"
#include "study/verification/winner_check.hpp"

namespace armwright::fuzz {
namespace {

template <class Parse>
void check(std::string_view input, const char* file, const Parse& parse) {
  is_read([&] {
    const std::string text = to_json(parse(std::string(input), file));
    try {
      require(to_json(parse(text, file)) == text, "another record is read back");
    } catch (const Error& error) {
      throw BrokenPromise(std::string("a record is not read back: ") + error.what());
    }
  });
}

// Whoever reads a result goes through its lists side by side.
void check_sizes(const RunResult& result, const Evaluation& evaluation) {
  const auto fits = [](std::size_t found, std::size_t named) {
    return found == 0 || found == named;
  };
  require(fits(evaluation.objectives.size(), result.objectives.size()) &&
              fits(evaluation.metrics.size(), result.metric_names.size()),
          "an evaluation has more or fewer numbers than names");
  if (!evaluation.objectives.empty()) {
    calc_target(result, evaluation);
  }
}

void check_result(const RunResult& result) {
  require(!result.winner || *result.winner < result.judged.size(), "a winner that there is not");
  get_target(result);
  for (const JudgedCandidate& judged : result.judged) {
    require(judged.candidate.x.size() == result.variable_names.size(), "a point out of line");
    for (std::size_t i = 0; i < judged.candidate.x.size(); ++i) {
      if (const DecisionVariable* const discrete = find_discrete(result, i)) {
        format_value(*discrete, judged.candidate.x[i]);
      }
    }
    check_sizes(result, judged.validation);
  }
  check_sizes(result, result.test);
}

void check_checksums(std::string_view input) {
  const auto& folder = get_scratch_folder("checksums");
  write_scratch(folder / kChecksumFile, input);
  is_read([&] {
    require(format_checksums(FolderChecksums(folder).lines()) == input,
            "other checksums are written than were read");
  });
}

}  // namespace

void fuzz_records(std::string_view input) {
  check_checksums(input);
  is_read([&] { check_result(parse_result(std::string(input), "result.json")); });
  check(input, "result.json", parse_result);
  check(input, "check.json", parse_check);
  check(input, "cell.json", parse_cell);
  check(input, "attempt.json", parse_attempt);
}

}  // namespace armwright::fuzz
