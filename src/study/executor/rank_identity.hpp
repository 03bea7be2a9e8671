// What must be the same on all ranks for their results to be the same to the last bit.
#pragma once

#include <span>
#include <string>

#include "problems/config/problem_loader.hpp"
#include "study/executor/rank_messages.hpp"

namespace armwright {

// Program, libraries and the whole configuration of these problems, as JSON text.
std::string make_rank_identity(std::span<const LoadedProblem* const> problems);

// This machine's part.
WorkerIntroduction make_introduction(unsigned threads);

}  // namespace armwright
