// Designs' motions on test cases, for the replay and for errors over time. Only .cpp files include
// this.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "problems/tracking/tracking_problem.hpp"
#include "report/evidence/page_simulator.hpp"

namespace armwright {

struct NamedDesign {
  std::string id;    // "winner"
  std::string name;  // as shown
  ArmDesign design;
  // That it is simulated in, as by a method that makes other efforts in advance; null: the one of
  // the designs beside it. All of them share robot, task and cases.
  const TrackingProblem* problem = nullptr;
};

struct ReplayRequest {
  TestSet set;
  std::uint64_t number = 0;
  std::string label;  // "test/2, case 17: the worst of 500"
};

// "test/2:17"
std::string make_case_id(const std::string& set, std::uint64_t number);

nlohmann::json make_design_info(const NamedDesign& design);
nlohmann::json make_task_info(const TrackingTask& task);

// Designs that one replay can show together, in their order: of the same arm, with the same targets
// in the same steps. Most problems have one such group; a design can stretch links or have a speed
// of its own, a method a control period.
std::vector<std::vector<NamedDesign>> divide_by_motion(const TrackingProblem& problem,
                                                       std::span<const NamedDesign> designs);
// Without load, and without motors, which are not drawn.
RobotModel make_shown_arm(const TrackingProblem& problem, const NamedDesign& design);

struct ReplayText {
  std::string id;
  std::string title;
};

// Of the group with that index: which designs it has, if it is not the only one.
ReplayText make_group_text(ReplayText text, std::span<const std::vector<NamedDesign>> groups,
                           std::size_t group);

// ReplaySet: every design on every case, by the problem's judging engine; the motion of a
// simulation that diverged goes as far as it went. `designs` are one group of divide_by_motion(),
// `robot` is the index of their robot with its load. The bulk is single precision: a hundredth of a
// micrometre.
nlohmann::json make_replay_set(PageSimulator& simulator, const TrackingProblem& problem,
                               const ReplayText& text, std::size_t robot,
                               std::span<const NamedDesign> designs,
                               std::span<const ReplayRequest> cases);

}  // namespace armwright
