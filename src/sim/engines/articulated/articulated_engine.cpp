#include "sim/engines/articulated/articulated_engine.hpp"

#include <algorithm>

#include "sim/engines/articulated/lane_block.hpp"
#include "sim/engines/articulated/plant_numbers.hpp"
#include "sim/tracking/engine_support.hpp"

namespace armwright {
namespace {

using namespace articulated;

// Count of packs of lanes that go through the timeline together. It is large enough to refill the
// lanes of simulations that ended early, and small enough for the cache.
constexpr std::size_t kGroups = 16;

bool have_same_timeline(const TargetTable& a, const TargetTable& b) {
  if (&a == &b) {
    return true;
  }
  if (a.segments.size() != b.segments.size()) {
    return false;
  }
  for (std::size_t k = 0; k < a.segments.size(); ++k) {
    if (a.segments[k].steps != b.segments[k].steps ||
        a.segments[k].window_start != b.segments[k].window_start) {
      return false;
    }
  }
  return true;
}

bool have_same_shape(const ChainModel& a, const ChainModel& b) {
  return &a == &b || (a.flags() == b.flags() && a.tilted_gravity() == b.tilted_gravity());
}

bool have_same_drives(const RobotModel& a, const RobotModel& b) {
  if (&a == &b) {
    return true;
  }
  for (std::size_t i = 0; i < a.joint_count(); ++i) {
    const JointPlant& its = a.joints[i].plant;
    const JointPlant& other = b.joints[i].plant;
    if (get_drive_flags(its) != get_drive_flags(other) ||
        its.counterbalance != other.counterbalance || a.joints[i].lower != b.joints[i].lower ||
        a.joints[i].upper != b.joints[i].upper) {
      return false;
    }
  }
  return true;
}

// Throws Error{usage}, as every engine does, if the design's numbers make no controller.
void check_design(const ArmDesign& design, const RobotModel& robot, const ArmDrives& drives) {
  const ControllerRow& row = find_controller(design.controller);
  for (std::size_t i = 0; i < design.joints.size(); ++i) {
    const Joint& joint = robot.joints[i];
    row.make(design.joints[i].gains, drives.get_command_limits(joint, design.joints[i].limits),
             joint.kind);
  }
}

template <class T>
class ArticulatedEngine final : public PhysicsEngine {
 public:
  explicit ArticulatedEngine(SimdLevel level) : kernels_(get_kernels<T>(level)) {}

  std::vector<TrackingResult> simulate(const TrackingSetup& setup,
                                       std::span<const TrackingJob> jobs) const override {
    std::vector<TrackingResult> results(jobs.size());
    // Groups of jobs with the same timeline, shape of the arm, controller and parts of the plant.
    // These decide which code runs, and that must not depend on the other jobs of a batch.
    std::vector<std::vector<std::size_t>> alike;
    const auto get_setup = [&](std::size_t job) -> const TrackingSetup& {
      return jobs[job].choose_setup(setup);
    };
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      if (i == 0 || jobs[i].design != jobs[i - 1].design) {
        check_design(*jobs[i].design, setup.robot(), setup.task().drives);
      }
      check_controller(setup.task(), jobs[i]);
      if (apply_unreachable(jobs[i], results[i])) {
        continue;
      }
      const TargetTable& targets = *jobs[i].targets;
      const auto found = std::find_if(alike.begin(), alike.end(), [&](const auto& group) {
        return have_same_timeline(*jobs[group.front()].targets, targets) &&
               have_same_shape(get_setup(group.front()).chain(), get_setup(i).chain()) &&
               have_same_drives(get_setup(group.front()).robot(), get_setup(i).robot()) &&
               jobs[group.front()].design->controller == jobs[i].design->controller &&
               (jobs[group.front()].variation == nullptr) == (jobs[i].variation == nullptr);
      });
      (found == alike.end() ? alike.emplace_back() : *found).push_back(i);
    }
    for (const std::vector<std::size_t>& group : alike) {
      const bool has_plant =
          get_setup(group.front()).robot().has_plant() || setup.task().drives.has_loops();
      const Kernel<T>& kernel = has_plant ? kernels_.plant : kernels_.ideal;
      const std::size_t most = kGroups * static_cast<std::size_t>(kernel.lanes);
      for (std::size_t first = 0; first < group.size(); first += most) {
        const std::size_t count = std::min(most, group.size() - first);
        simulate_block(setup, kernel, jobs,
                       std::span<const std::size_t>(group).subspan(first, count), results);
      }
    }
    return results;
  }

  bool has_derivatives() const override { return true; }
  std::vector<double> calc_derivatives(const TrackingSetup& setup, const TrackingJob& job,
                                       std::span<const ArmDesign> directions) const override {
    if (job.variation != nullptr) {
      throw std::logic_error("there are no derivatives of a perturbed plant");
    }
    if (!job.targets->unreachable.empty()) {
      return {};
    }
    check_controller(setup.task(), job);
    return calc_point_derivatives(setup, job, directions);
  }

  BatchSize batch_size() const override {
    const auto lanes = static_cast<std::size_t>(kernels_.ideal.lanes);
    return {lanes, kGroups * lanes};
  }

 private:
  Kernels<T> kernels_;
};

}  // namespace

std::unique_ptr<PhysicsEngine> make_articulated_engine(const EngineOptions& options) {
  if (options.precision == Precision::single) {
    return std::make_unique<ArticulatedEngine<float>>(*options.simd);
  }
  return std::make_unique<ArticulatedEngine<double>>(*options.simd);
}

}  // namespace armwright
