// Simulations with what is required of them measured.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "problems/tracking/requirement.hpp"
#include "sim/tracking/physics_engine.hpp"

namespace armwright {

// What a case has of a required quantity, and where it has it.
struct RequiredValue {
  std::optional<double> value;       // nothing if there is nothing to measure it on
  std::optional<std::size_t> joint;  // of all that count, the one with the largest value
  std::optional<std::size_t> point;  // likewise, the first after the start being 1
};

struct MeasuredCase {
  TrackingResult result;                // without the motion, unless its job asked for it
  std::vector<RequiredValue> required;  // one a requirement
};

// One a job, whatever becomes of it; of a simulation that ended early, up to there. Where the
// motion must be recorded, the engine gets as many jobs at a time as leave none of its lanes idle:
// a case of 4000 periods takes some 200 kB until it is measured.
std::vector<MeasuredCase> simulate_measured(const PhysicsEngine& engine, const TrackingSetup& setup,
                                            std::span<const TrackingJob> jobs,
                                            std::span<const Requirement> requirements);

// The requirements' numbers in an outcome's metrics, one each (requirement.hpp): of a case in
// training or, as it is, of one that is judged.
std::vector<double> make_required_metrics(std::span<const Requirement> requirements,
                                          const MeasuredCase& measured, const TargetTable& targets,
                                          bool in_training);
// Over the outcomes that have an error the largest of their last `count` metrics, one by one.
std::vector<double> calc_worst_required(std::span<const CaseOutcome> outcomes, std::size_t count);

// Error{bad_data} if a requirement is of moves, and the case has none that counts.
void check_moves(std::span<const Requirement> requirements, const TrackingTask& task,
                 const TargetTable& targets, const std::string& set, std::uint64_t number);

}  // namespace armwright
