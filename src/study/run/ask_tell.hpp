// Ask and tell: a run whose evaluations somebody else makes, for example on a test bench or in the
// queue of another system. It is an ordinary run: ask() replays it from its journal, stops where the
// optimizer asks for something that the journal lacks, and hands these points out. tell() appends
// their results to the journal. The last ask() ends the run.
//
// The file asked.json of the run's folder holds the points that were handed out and have no result
// yet. An identifier is the index of the evaluation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "problems/user/case_server.hpp"
#include "study/run/run.hpp"

namespace armwright {

inline constexpr const char* kAskedFile = "asked.json";

// A point that waits for its result.
struct AskedPoint {
  std::uint64_t id = 0;
  std::vector<double> x;
};

struct AskOutcome {
  std::vector<AskedPoint> points;   // handed out by this call
  std::vector<AskedPoint> waiting;  // handed out before, without a result; the search needs them
  std::optional<RunResult> result;  // set if the run has ended
};

// The answer to one point. `where` names its place in messages: "results.csv:3".
struct ToldAnswer {
  std::uint64_t id = 0;
  CaseAnswer answer;
  std::string where;
};

// Sets what a plan of ask and tell has beside others: only evaluated decision vectors are judged.
// Throws Error{usage} if the problem is not one of the user or has several cases, or if the run
// would race: a decision vector has one result here.
void prepare_to_ask(RunPlan& plan);

// Hands out at most `count` points of those that the optimizer asks for together. A sequential
// optimizer asks for one. If all of them were handed out before, returns no new point. Ends the run
// if the optimizer asks for nothing any more. Throws what execute_run() throws, and
// Error{bad_data} if asked.json is damaged or holds other points than the optimizer asks for.
AskOutcome ask(RunRequest request, std::size_t count, RunObserver& observer);

// Appends the results of points that were handed out, in any order. Either all answers are recorded
// or none. Throws Error{usage} if an identifier was never handed out or has a result already,
// Error{busy} if another process writes the run, Error{bad_data} if a file of the folder is damaged,
// and Error{io}. `problem` is the problem of the run.
void tell(const std::filesystem::path& folder, const Problem& problem,
          std::span<const ToldAnswer> answers);

// Reads results, at most one per line. JSON lines are objects with "id" and the fields of an answer
// of the protocol (docs/problem-protocol.md), or "missing" with a reason. CSV has a header with the
// columns "id", "missing" and the names of objectives, constraints and metrics; columns with the
// names of variables are ignored. `name` is the file's name in messages. Throws Error{bad_data} that
// names the line.
std::vector<ToldAnswer> read_told(std::string_view text, const std::string& name,
                                  const Problem& problem);

}  // namespace armwright
