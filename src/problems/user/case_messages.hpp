// The messages about cases between armwright and the program of a problem
// (docs/problem-protocol.md).
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "problems/user/case_server.hpp"

namespace armwright {

// Returns the number that a case can draw its random numbers from: a hash of the names of the set
// and of the case, at most 2^53 - 1.
std::uint64_t calc_case_seed(const CaseBlock& block, std::uint64_t number);

// Makes the message "evaluate" or, for one job, "record". All jobs belong to one block.
std::string make_question(const UserDescription& description, const char* type, std::uint64_t id,
                          std::span<const CaseJob> jobs);

// Reads a message "answers" to the question `id` and appends its answers, of which at most `most`
// may come. Throws ProtocolError.
void read_answers(const nlohmann::json& message, const UserDescription& description,
                  std::uint64_t id, std::size_t most, std::vector<CaseAnswer>& answers);
// Reads one answer: an object, or the number of the only objective. Throws ProtocolError, whose
// message calls the answer `where`.
CaseAnswer read_answer(const nlohmann::json& answer, const UserDescription& description,
                       const std::string& where);
// Reads the message "record". Throws ProtocolError.
CaseRecord read_record(const nlohmann::json& message, std::uint64_t id);

// Refuses an answer that has not one number per objective, constraint and metric. `where` names it.
void check_answer(const CaseAnswer& answer, const UserDescription& description,
                  const std::string& where);

}  // namespace armwright
