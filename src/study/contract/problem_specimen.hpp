// What the checks of a problem's contract (problem_contract.hpp) ask a problem, and how they compare
// its answers.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "problems/config/problem_loader.hpp"
#include "problems/user/user_problem.hpp"
#include "study/contract/problem_contract.hpp"

namespace armwright {

// One design on one case.
struct Question {
  std::vector<double> x;
  std::uint64_t number = 0;
};

// A problem that was loaded for one check.
class Specimen {
 public:
  explicit Specimen(const ProblemTrial& trial);

  const LoadedProblem& loaded() const { return loaded_; }
  const Problem& problem() const { return *loaded_.problem; }
  const ProblemDescription& description() const { return problem().description(); }
  bool is_user_problem() const { return find_user_description(problem()) != nullptr; }

  // Returns the start and a few designs from all over the box, each on every case.
  std::vector<Question> make_questions() const;
  // Returns designs with one variable at a bound, or with each word of a category, on one case.
  std::vector<Question> make_corners() const;
  std::vector<double> get_start() const;

  std::vector<CaseOutcome> ask(std::span<const Question> questions, bool residuals = false) const;
  // Asks each question alone.
  std::vector<CaseOutcome> ask_singly(std::span<const Question> questions) const;

  // Returns "x=1 kind=round on case 3".
  std::string describe(const Question& question) const;
  // Returns "QUESTION: why it failed", with what the program printed last, on one line.
  std::string describe_failure(const Question& question, const CaseOutcome& outcome) const;
  std::string describe_failure(std::string_view what, const CaseOutcome& outcome) const;
  // Returns the first difference of two answers to the same questions as text; empty if there is
  // none. `how` says how the second answers were asked for.
  std::string compare(std::span<const Question> questions, std::span<const CaseOutcome> first,
                      std::span<const CaseOutcome> second, std::string_view how) const;

 private:
  std::vector<Question> cross(const std::vector<std::vector<double>>& designs) const;
  std::string compare(const Question& question, const CaseOutcome& a, const CaseOutcome& b) const;

  LoadedProblem loaded_;
  CaseBlock block_;
};

}  // namespace armwright
