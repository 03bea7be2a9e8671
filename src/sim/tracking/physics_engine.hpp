// The interface of physics engines. An engine simulates a batch of (design, test case) jobs. Results do
// not depend on the batch that a job is in, on the thread, or on earlier calls.
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
#include "sim/tracking/tracking.hpp"

namespace armwright {

class PhysicsEngine {
 public:
  virtual ~PhysicsEngine() = default;
  // Thread-safe. A simulation that fails is a status in its result; exceptions are for bugs and
  // lack of memory.
  virtual std::vector<TrackingResult> simulate(const TrackingSetup& setup,
                                               std::span<const TrackingJob> jobs) const = 0;
  // Whether calc_derivatives() works.
  virtual bool has_derivatives() const { return false; }
  // Exact derivatives of the errors (m) of the job's points as simulate() would compute them: a row
  // for each point of the timeline, a column for each direction, row after row. A direction is a
  // design whose gains and limits are the derivatives of the job's with respect to some variable.
  // Where a simulation has a kink (a limit, the largest of several, a turn that is left out), those
  // of the branch that it took; 0 for a point that was not reached, whose error is 0, or whose
  // derivative exceeds all numbers. Nothing for a case that cannot be simulated. The job must have
  // no PlantVariation: rounded angles have no derivative. Thread-safe.
  virtual std::vector<double> calc_derivatives(const TrackingSetup& setup, const TrackingJob& job,
                                               std::span<const ArmDesign> directions) const;
  // How many jobs one call should get; any number is simulated alike.
  virtual BatchSize batch_size() const = 0;
};

enum class Precision : std::uint8_t { double_, single };
const char* to_string(Precision precision);  // "double", "float"
std::vector<std::string> precision_names();
Precision parse_precision(std::string_view name);  // Error{usage} if there is none of that name

struct EngineOptions {
  Precision precision = Precision::double_;
  std::optional<SimdLevel> simd;  // nothing: the best of this machine
};

}  // namespace armwright
