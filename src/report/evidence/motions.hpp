// Simulates the motions of designs on test cases, for the replay and for errors over time, and
// chooses the cases of a replay. Only .cpp files include this.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "problems/tracking/tracking_problem.hpp"
#include "report/evidence/page_simulator.hpp"

namespace armwright {

// The names, on all pages, of the design from which an optimization starts: one that somebody chose,
// or one that armwright proposed for the arm.
inline constexpr const char* kBaseControllers = "base controllers";
inline constexpr const char* kProposedControllers = "proposed controllers";

// A design that a page shows.
struct NamedDesign {
  std::string id;    // "winner"
  std::string name;  // as shown
  ArmDesign design;
  // The design's own problem, if its method precomputes other efforts; null: the problem that the
  // other designs have. All problems share robot, task and cases. Not owned.
  const TrackingProblem* problem = nullptr;
};

nlohmann::json make_design_info(const NamedDesign& design, const RobotModel& robot);
nlohmann::json make_task_info(const TrackingTask& task);

// ---- Cases -------------------------------------------------------------------------------------

// A test case to replay.
struct ReplayRequest {
  TestSet set;
  std::uint64_t number = 0;
  std::string label;  // "test/2, case 17: the worst of 500"
};

// Returns "test/2:17".
std::string make_case_id(const std::string& set, std::uint64_t number);

// A list of replays without duplicates. A case that is added twice keeps its first reason. The
// problem must outlive the list.
class ReplayList {
 public:
  explicit ReplayList(const TrackingProblem& problem) : problem_(problem) {}

  void add(const std::string& set, std::uint64_t number, const std::string& reason);
  // `case_id` reads "test/2:17". Throws Error{usage} for anything else.
  void add(const std::string& case_id, const std::string& reason);
  std::vector<ReplayRequest> take() { return std::move(requests_); }

 private:
  const TrackingProblem& problem_;
  std::vector<ReplayRequest> requests_;
};

// The reason of cases that the user asked for.
inline constexpr const char* kAskedFor = "asked for";

// Returns the index of the largest error. A NaN counts as larger than every number. The list must
// not be empty.
std::size_t find_worst_case(std::span<const double> errors);

// ---- Replays -----------------------------------------------------------------------------------

// Divides designs into groups that one replay can show together, in their order. The designs of a
// group have the same arm, the same targets and the same control period. Most problems have one
// group; a design may change links or the speed, and a method may have its own control period.
std::vector<std::vector<NamedDesign>> divide_by_motion(const TrackingProblem& problem,
                                                       std::span<const NamedDesign> designs);
// Returns the arm with the design's links, without the load and without the motors' masses, which
// are not drawn.
RobotModel make_shown_arm(const TrackingProblem& problem, const NamedDesign& design);

struct ReplayText {
  std::string id;
  std::string title;
};

// Returns the text for the group with this index. If there are several groups, the title names the
// group's designs.
ReplayText make_group_text(ReplayText text, std::span<const std::vector<NamedDesign>> groups,
                           std::size_t group);

// Returns ReplaySet of web/src/data.ts: every design on every case, simulated by the judging
// engine. The motion of a diverged simulation ends where it diverged. `designs` are one group of
// divide_by_motion(); `robot` is the index of their robot with its load. Most numbers have single
// precision, which is exact to a hundredth of a micrometre. Throws WorkStopped.
nlohmann::json make_replay_set(PageSimulator& simulator, const TrackingProblem& problem,
                               const ReplayText& text, std::size_t robot,
                               std::span<const NamedDesign> designs,
                               std::span<const ReplayRequest> cases);

// A motion that no simulation made, such as a recorded one. Rows are one period of the task apart, and
// row 0 is the start; a row has one number per joint (rad or m; N m or N).
struct GivenMotion {
  std::string id, label, set;
  std::vector<float> q, effort;
};

// Returns ReplaySet of motions without targets, all of the same arm. `design` is the name that the page
// shows, and `robot` the index of the arm, whose joints have `effort_limits` (pairs of numbers or null).
nlohmann::json make_given_replay_set(const ReplayText& text, const std::string& design,
                                     std::size_t robot, const TrackingTask& task,
                                     const nlohmann::json& effort_limits,
                                     std::span<const GivenMotion> motions);

}  // namespace armwright
