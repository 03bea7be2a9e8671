// The interface of physics engines. An engine simulates a batch of (design, test case) jobs.
// Results do not depend on the batch that a job is in, on the thread, or on earlier calls.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/batch_size.hpp"
#include "sim/simd/simd_level.hpp"
#include "sim/tracking/simulation.hpp"

namespace armwright {

// Immutable: any number of threads may call the functions of one engine.
class PhysicsEngine {
 public:
  virtual ~PhysicsEngine() = default;
  // Returns one result per job. A simulation that fails is a status in its result. Throws
  // Error{usage} if a design's numbers make no controller, or if a job lacks feed-forward efforts.
  // Other exceptions mean a bug or lack of memory.
  virtual std::vector<TrackingResult> simulate(const TrackingSetup& setup,
                                               std::span<const TrackingJob> jobs) const = 0;
  // Returns whether calc_derivatives() works.
  virtual bool has_derivatives() const { return false; }
  // Returns the exact derivatives of the errors (m) of the job's points as simulate() computes
  // them: one row per point of the timeline, one column per direction, row-major. A direction is a
  // design whose gains and limits are the derivatives of the job's with respect to some variable.
  //
  // Where a simulation has a kink (a limit, the largest of several numbers, a turn that is left
  // out), the derivatives are those of the branch that it took. They are 0 for a point that was not
  // reached, for a point whose error is 0, and where a derivative is not finite.
  //
  // Returns nothing for a case that cannot be simulated. Throws std::logic_error if the engine has
  // no derivatives, or if the job has a PlantVariation: rounded positions have no derivative.
  virtual std::vector<double> calc_derivatives(const TrackingSetup& setup, const TrackingJob& job,
                                               std::span<const ArmDesign> directions) const;
  // Returns how many jobs one call should get. Results do not depend on it.
  virtual BatchSize batch_size() const = 0;
};

enum class Precision : std::uint8_t { double_, single };
const char* to_string(Precision precision);  // "double", "float"
std::vector<std::string> precision_names();
// Throws Error{usage} if there is no precision of that name.
Precision parse_precision(std::string_view name);

struct EngineOptions {
  Precision precision = Precision::double_;
  std::optional<SimdLevel> simd;  // empty: the best one of this machine
};

}  // namespace armwright
