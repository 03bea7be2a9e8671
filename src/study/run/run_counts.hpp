// What a run has evaluated, in numbers.
#pragma once

#include <cstdint>

#include "study/journal/evaluation_record.hpp"

namespace armwright {

struct RunCounts {
  void add(const EvaluationRecord& record);  // one more of training; not whether it is replayed

  std::uint64_t evaluations = 0;
  std::uint64_t cases = 0;      // charged to the budget
  std::uint64_t replayed = 0;   // evaluations answered from the journal
  std::uint64_t clipped = 0;    // points asked for outside the bounds
  std::uint64_t failed = 0;     // evaluations whose status is neither ok nor abandoned
  std::uint64_t abandoned = 0;  // those that lost a race
  std::uint64_t feasible = 0;   // evaluations with objectives and every constraint met
  std::uint64_t generations = 0;
};

}  // namespace armwright
