// The subcommands, each in a file of its own. Each function adds one subcommand to the parser. If
// the user chooses the subcommand, the parser stores its work in Session::action.
#pragma once

#include <string>

#include "problems/config/problem_loader.hpp"

namespace CLI {
class App;
}

namespace armwright {

struct Session;

void add_list(CLI::App& app, Session& session);
void add_optimize(CLI::App& app, Session& session);
void add_ask(CLI::App& app, Session& session);
void add_tell(CLI::App& app, Session& session);
void add_compare(CLI::App& app, Session& session);
void add_cell(CLI::App& app, Session& session);
void add_status(CLI::App& app, Session& session);
void add_merge(CLI::App& app, Session& session);
void add_rerun(CLI::App& app, Session& session);
void add_evaluate(CLI::App& app, Session& session);
void add_sweep(CLI::App& app, Session& session);
void add_verify(CLI::App& app, Session& session);
void add_reproduce(CLI::App& app, Session& session);
void add_testset(CLI::App& app, Session& session);
void add_show(CLI::App& app, Session& session);
void add_report(CLI::App& app, Session& session);
void add_plot(CLI::App& app, Session& session);
void add_watch(CLI::App& app, Session& session);
void add_export(CLI::App& app, Session& session);
void add_import(CLI::App& app, Session& session);
void add_check_plugin(CLI::App& app, Session& session);
void add_new_plugin(CLI::App& app, Session& session);
void add_check_problem(CLI::App& app, Session& session);
void add_new_problem(CLI::App& app, Session& session);
void add_doctor(CLI::App& app, Session& session);
void add_manual(CLI::App& app, Session& session);
void add_completion(CLI::App& app, Session& session);

// evaluate_own.cpp: the part of evaluate for problems without an arm.

struct OwnEvaluation {
  std::string design;  // a file as values_file.hpp reads it
  std::string cases;   // as typed after --cases; empty: all test cases
  std::string test_set;
  unsigned jobs = 1;
  bool json = false;
  bool quiet = false;
};
int evaluate_own(const LoadedProblem& problem, const OwnEvaluation& options, Session& session);

}  // namespace armwright
