// Physics engines behind one interface, and the explicit table of them. An engine simulates a batch
// of (design, test case) jobs; results do not depend on the batch a job is in, on the thread or on
// what ran before.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/batch_size.hpp"
#include "sim/simd_level.hpp"
#include "sim/tracking.hpp"

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

struct EngineRow {
  std::string name;
  std::string summary;
  bool simd = false;  // works in SIMD lanes: precision and SIMD level can be chosen
  // Of an engine with SIMD, `simd` has a value that this CPU supports.
  std::unique_ptr<PhysicsEngine> (*make)(const EngineOptions& options);
};

// An optional engine that this build leaves out.
struct MissingEngine {
  std::string name;
  std::string reason;  // and what to do about it
};

const std::vector<EngineRow>& engine_table();
const std::vector<MissingEngine>& missing_engine_table();
std::vector<std::string> engine_names();
// Error{usage} if there is none of that name, or this build leaves it out.
const EngineRow& find_engine(std::string_view name,
                             std::span<const EngineRow> table = engine_table());

// Precision and SIMD level as the engine will use them: of one with SIMD the level is set to the
// best of this machine where none is given. Error{usage} for a choice that the engine does not
// have, and for a level that this CPU lacks.
EngineOptions resolve_options(const EngineRow& engine, EngineOptions options);
std::unique_ptr<PhysicsEngine> make_engine(std::string_view name,
                                           const EngineOptions& options = {});

}  // namespace armwright
