// Designs under other conditions than they were made for: another average speed of the target, the
// thesis's Fig. 6.16. Only .cpp files include this.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "report/evidence/motions.hpp"

namespace armwright {

struct SweepRequest {
  std::vector<double> speeds_m_per_s;
  std::string set;          // "test/2"
  std::uint64_t cases = 0;  // the first of it
  std::string command;      // that makes its numbers anew
};

// Sweep over task.speed_m_per_s: every design at every speed on the same cases, by the problem's
// judging engine; the problem's own speed is the nominal one.
nlohmann::json make_speed_sweep(PageSimulator& simulator, const TrackingProblem& problem,
                                const SweepRequest& request, std::span<const NamedDesign> designs);

}  // namespace armwright
