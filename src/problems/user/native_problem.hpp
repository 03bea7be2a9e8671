// Problems behind the C interface (include/armwright/problem.h): what the process that has the
// functions does with them. It is a process that has opened a shared library, or a program that
// uses armwright as a library.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "armwright/problem.h"
#include "problems/user/case_server.hpp"

namespace armwright {

// Returns the problem in the form of this version: fields that its author's header lacked are zero.
// Throws ProtocolError if this version cannot use it.
struct armwright_user_problem read_native_problem(const struct armwright_user_problem* raw);

// Returns the description. Throws ProtocolError for fields that no description can hold;
// read_user_description() checks all others.
UserDescription describe_native_problem(const struct armwright_user_problem& problem);

// Calls the functions of a problem, from one thread. `problem` must live longer.
class NativeCaller {
 public:
  explicit NativeCaller(const struct armwright_user_problem& problem);
  NativeCaller(const NativeCaller&) = delete;
  NativeCaller& operator=(const NativeCaller&) = delete;

  // One answer. It is valid until the next ask().
  struct Answer {
    std::int32_t status;
    const char* reason;
    std::span<const double> numbers;  // objectives, constraints, metrics
    const std::vector<double>& residuals;
  };

  // Asks at most kMostQuestions questions. Calls `on_answered` with the number of answers so far,
  // after each call of the problem's functions.
  void ask(std::span<const armwright_case> questions,
           const std::function<void(std::size_t answered)>& on_answered);
  Answer answer(std::size_t i) const;

  // Returns the message "record" of docs/problem-protocol.md for a case. Throws ProtocolError if the
  // problem cannot record it.
  std::string record(const armwright_case& question, std::uint64_t id) const;

  static constexpr std::size_t kMostQuestions = 1000;
  static constexpr std::size_t kReasonBytes = 301;  // with the zero byte

 private:
  const struct armwright_user_problem& problem_;
  std::size_t width_;  // numbers per answer
  std::vector<double> numbers_;
  std::vector<char> reasons_;
  std::vector<std::vector<double>> residuals_;
  std::vector<armwright_answer> answers_;
  std::vector<armwright_answer*> answer_list_;
};

// Makes the answer of a case from what a problem has left. Throws ProtocolError for a status that
// this version does not know, and for ARMWRIGHT_CASE_BROKEN.
CaseAnswer make_answer(const UserDescription& description, std::int32_t status,
                       std::string_view reason, std::span<const double> numbers,
                       std::vector<double> residuals);

// Makes the question of a job. It refers to the job's vector and block.
armwright_case make_native_question(const UserDescription& description, const CaseJob& job);

// Makes a server that calls the problem on the thread that asks. `problem` must live longer.
std::unique_ptr<CaseServer> make_native_server(const struct armwright_user_problem& problem,
                                               UserDescription description);

}  // namespace armwright
