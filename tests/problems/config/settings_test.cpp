// The declarations of settings: every one of them is what a reader reads.
#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>

#include "problems/changed_text.hpp"
#include "problems/config/problem_readers.hpp"
#include "problems/problem_folder.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const AnySetting& find(const SettingTable& file, const std::string& path) {
  for (const ListedSetting& one : list_settings(file)) {
    if (one.path == path) {
      return *one.setting;
    }
  }
  throw std::logic_error("there is no setting " + path);
}

// A problem in which every table has a header, so that any key can be put into any table.
constexpr const char* kEveryTable = R"(kind = "tracking"
[robot]
urdf = "irb4600_40_255"
[task]
[control]
[workspace]
[physics]
[training]
[schedule]
[racing]
[sets]
[run]
[objective]
[variables]
start = "table-a1"
[[variables.joint]]
name = "joint_1"
optimize = ["p"]
[motors]
[[requirement]]
quantity = "settling_time"
limit_s = 0.1
[perturbation]
[published]
[sweep]
parameter = "task.speed_m_per_s"
values = [1]
design = "table-a1"
)";
constexpr const char* kPoints = R"([path]
kind = "points"
[[path.point]]
position_m = [1.4, 0, 0.9]
[[path.point]]
position_m = [1.4, 0.2, 0.9]
)";
constexpr const char* kFunction = "kind = \"analytic\"\n[function]\nname = \"sphere\"\n";

constexpr const char* kIdentificationProblem =
    "kind = \"identification\"\n[robot]\nurdf = \"planar2\"\n[identification]\nlogs = []\n";
constexpr const char* kExcitationProblem =
    "kind = \"excitation\"\n[robot]\nurdf = \"planar2\"\n[excitation]\n";
constexpr const char* kMotionProblem = R"(kind = "motion"
[robot]
urdf = "planar2"
[motion]
[[motion.point]]
joints = [0, 0]
[[motion.point]]
joints = [1, 0.5]
[[obstacle]]
kind = "sphere"
centre_m = [5, 5, 5]
radius_m = 0.1
[tubes]
diameter_m = [0.06]
wall_m = [0.003]
[objective]
)";
constexpr const char* kProgramProblem = "kind = \"program\"\n[program]\ncommand = \"exec:true\"\n";
constexpr const char* kCommandProblem = R"(kind = "command"
[command]
run = "true"
[[command.input]]
file = "in"
text = ""
[[variable]]
name = "x"
lower = 0
upper = 1
[[objective]]
name = "f"
exit_code = true
[[constraint]]
name = "g"
exit_code = true
[[metric]]
name = "m"
exit_code = true
[cases]
)";

struct Specimen {
  std::string text;
  std::vector<std::string> overrides;
};

// Returns a problem whose reader reads the setting.
Specimen make_specimen(const std::string& path) {
  static const std::map<std::string, std::vector<std::string>> overrides = {
      {"path.from_m", {"path.kind=line"}},
      {"path.to_m", {"path.kind=line", "path.from_m=[1.4,0,0.9]"}},
      {"path.repeats", {"path.kind=line", "path.from_m=[1.4,0,0.9]", "path.to_m=[1,0,0.9]"}},
      {"path.centre_m", {"path.kind=circle"}},
      {"path.normal", {"path.kind=circle", "path.centre_m=[1.4,0,0.9]"}},
      {"path.radius_m", {"path.kind=circle", "path.centre_m=[1.4,0,0.9]", "path.normal=[1,0,0]"}},
      {"path.start",
       {"path.kind=circle", "path.centre_m=[1.4,0,0.9]", "path.normal=[1,0,0]",
        "path.radius_m=0.1"}},
      {"path.file", {"path.kind=file"}},
      {"control.bandwidth_hz", {"control.interface=velocity"}},
      {"control.delay_s", {"control.interface=velocity"}},
      {"control.resolution_rad", {"control.interface=velocity"}},
      {"control.resolution_m", {"control.interface=velocity"}},
      {"identification.payload_com_m", {"identification.payload_kg=1"}},
      {"excitation.payload_com_m", {"excitation.payload_kg=1"}},
      {"motion.payload_com_m", {"motion.payload_kg=1"}},
      {"motion.effort_share_bounds", {"motion.curve=line"}},
      {"racing.first_cases", {"racing.kind=halving"}},
      {"racing.eta", {"racing.kind=halving"}},
      {"racing.margin", {"racing.kind=abandonment"}},
      {"racing.chunk_cases", {"racing.kind=abandonment"}},
      {"schedule.factor", {"schedule.kind=growing"}},
      {"objective.cvar_share", {"objective.statistic=cvar"}},
      {"objective.failure_penalty_m", {"objective.statistic=mean_with_failures"}},
      {"objective.energy_scale_j", {"objective.energy_weight=1"}},
      {"objective.duration_scale_s", {"objective.duration_weight=1"}},
      {"objective.error_limit_m", {"objective.kind=torque_with_error_limit"}},
      {"objective.total_torque_limit_n_m", {"objective.kind=error_with_torque_limit"}},
  };
  Specimen specimen{kEveryTable, {}};
  if (path.starts_with("path.")) {
    specimen.text += kPoints;
  } else if (path.starts_with("function.")) {
    specimen.text = kFunction;
  } else if (path.starts_with("program.")) {
    specimen.text = kProgramProblem;
  } else if (path.starts_with("identification.")) {
    specimen.text = kIdentificationProblem;
  } else if (path.starts_with("excitation.")) {
    specimen.text = kExcitationProblem;
  } else if (path.starts_with("motion.") || path.starts_with("obstacle[]") ||
             path.starts_with("tubes.") || path == "objective.quantities" ||
             path == "objective.weights" || path == "objective.scales") {
    specimen.text = kMotionProblem;
    const auto replace = [&](const std::string& what, const std::string& with) {
      specimen.text.replace(specimen.text.find(what), what.size(), with);
    };
    if (path.find(".tool_") != std::string::npos) {
      replace("joints = [0, 0]", "tool_m = [0.9, 0, 1]");
    } else if (path == "obstacle[].edges_m" || path == "obstacle[].rpy_rad") {
      replace("kind = \"sphere\"", "kind = \"box\"\nedges_m = [1, 1, 1]");
    } else if (path == "obstacle[].height_m") {
      replace("kind = \"sphere\"", "kind = \"cylinder\"");
    } else if (path == "obstacle[].file" || path == "obstacle[].position_m") {
      replace("kind = \"sphere\"", "kind = \"urdf\"\nfile = \"planar2\"");
    } else if (path == "obstacle[].from_m" || path == "obstacle[].to_m") {
      replace("kind = \"sphere\"", "kind = \"capsule\"\nfrom_m = [5, 5, 5]\nto_m = [6, 6, 6]");
    }
  } else if (const auto part = path.substr(0, path.find_first_of(".["));
             part == "command" || part == "variable" || part == "constraint" || part == "metric" ||
             part == "cases" || path.starts_with("objective[]")) {
    specimen.text = kCommandProblem;
    const auto replace = [&](const std::string& what, const std::string& with) {
      specimen.text.replace(specimen.text.find(what), what.size(), with);
    };
    if (path.ends_with(".template_text")) {
      replace("text = \"\"", "template = \"in\"");
    } else if (path.ends_with(".choices")) {
      replace("lower = 0\nupper = 1\n", "type = \"category\"\n");
    }
  }
  if (path == "requirement[].joint") {  // settling_time is of the whole arm
    const std::string tip = "quantity = \"settling_time\"\nlimit_s = 0.1\n";
    specimen.text.replace(specimen.text.find(tip), tip.size(),
                          "quantity = \"peak_torque\"\nlimit_n_m = 100\n");
  }
  if (const auto found = overrides.find(path); found != overrides.end()) {
    specimen.overrides = found->second;
  }
  return specimen;
}

// Returns a [[requirement]] with a date as this limit. A quantity of joints names a joint, one that
// slides if the limit is one of such joints.
std::string make_requirement(const std::string& limit) {
  for (const RequirementRow& row : requirement_table()) {
    if (row.limit_key == limit || row.slider_limit_key == limit) {
      return "[[requirement]]\nquantity = \"" + row.key + "\"\n" + limit + " = " + kDate + "\n" +
             (!row.of_joints           ? ""
              : row.limit_key == limit ? "joint = \"pivot\"\n"
                                       : "joint = \"rail\"\n");
    }
  }
  throw std::logic_error("no quantity has the limit " + limit);
}

TEST(Settings, AProblemsReaderReadsEveryOne) {
  const ProblemFolder folder;
  for (const ListedSetting& one : list_settings(problem_settings())) {
    const auto& [path, setting] = one;
    const auto& [text, overrides] = make_specimen(path);
    if (path.starts_with("requirement[].limit_")) {
      continue;  // the next test
    }
    const std::string message =
        folder.refusal_of(change_text(text, make_header(path), setting->key, kDate), overrides);
    EXPECT_THAT(message, HasSubstr(": " + make_first_path(path) + " is " + kDate +
                                   ", a date or time; it must be "));
    // The names of joints and the engines of this build are choices that the reader finds out.
    if (setting->key != "name" && setting->key != "joint") {
      EXPECT_THAT(message, testing::EndsWith("it must be " + setting->describe_allowed()));
    }
  }
}

TEST(Settings, AProblemsReaderReadsTheLimitsOfAllQuantities) {
  const ProblemFolder folder;
  folder.write("d.toml", make_joint() + make_joint());
  const std::string problem = "kind = \"tracking\"\n[robot]\nurdf = \"" ARMWRIGHT_TEST_DATA
                              "/urdf/rail_and_pole.urdf\"\n[variables]\nstart = \"d.toml\"\n";
  for (const ListedSetting& one : list_settings(problem_settings())) {
    if (one.path.starts_with("requirement[].limit_")) {
      EXPECT_THAT(folder.refusal_of(problem + make_requirement(one.setting->key)),
                  HasSubstr(": " + make_first_path(one.path) + " is " + kDate +
                            ", a date or time; it must be " + one.setting->describe_allowed()));
    }
  }
}

const ControllerRow& find_controller_with(const std::string& gain) {
  for (const ControllerRow& controller : controller_table()) {
    if (std::ranges::find(controller.gains, gain, &controllers::Gain::key) !=
        controller.gains.end()) {
      return controller;
    }
  }
  return find_controller("pid");
}

TEST(Settings, ADesignsReaderReadsEveryOne) {
  const ProblemFolder folder;
  for (const ListedSetting& one : list_settings(design_settings())) {
    const ControllerRow& controller = find_controller_with(one.setting->key);
    DesignFile design;
    design.design.controller = controller.name;
    design.joint_names = {"joint"};
    JointDrive drive;
    drive.gains.assign(controller.gains.size(), 1);
    design.design.joints = {drive};
    const std::string text = to_toml(design) + "[[published]]\nlabel = \"\"\nproblem = \"\"\n";
    EXPECT_THAT(
        folder.refusal_of_design(change_text(text, make_header(one.path), one.setting->key, kDate)),
        testing::AllOf(HasSubstr(": " + make_first_path(one.path) + " is " + kDate),
                       testing::EndsWith("it must be " + one.setting->describe_allowed())));
  }
}

TEST(Settings, EveryOneHasAMeaning) {
  std::set<std::string> paths;
  for (const SettingTable* file : {&problem_settings(), &design_settings()}) {
    for (const ListedSetting& one : list_settings(*file)) {
      EXPECT_THAT(one.setting->meaning, Not(IsEmpty())) << one.path;
      EXPECT_TRUE(paths.insert(file == &design_settings() ? "design:" + one.path : one.path).second)
          << one.path << " is there twice";
    }
  }
}

TEST(Settings, SayWhatTheReadersCheck) {
  const AnySetting& speed = find(problem_settings(), "task.speed_m_per_s");
  EXPECT_EQ(speed.unit, "m/s");
  EXPECT_EQ(speed.describe_allowed(), "a finite number >= 0.0001 and <= 100");
  EXPECT_EQ(speed.default_text, "1.5");
  EXPECT_EQ(find(problem_settings(), "schedule.kind").describe_allowed(),
            "one of these strings: fixed, fresh, coevolution, growing");
  // Required, and read only if the kind of the objective needs it.
  EXPECT_EQ(find(problem_settings(), "objective.error_limit_m").default_text, "");
  EXPECT_EQ(find(problem_settings(), "requirement[].limit_rad_per_s").unit, "rad/s");
}

TEST(Settings, DefaultsAreThoseOfAProblemThatLeavesThemOut) {
  const ProblemFolder folder;
  const LoadedProblem base = folder.load("base.toml");
  for (const ListedSetting& one : list_settings(problem_settings())) {
    // Settings of a kind that the problem does not have cannot be set to the default.
    const bool is_of_kind =
        one.path.starts_with("path.") || one.path.starts_with("function.") ||
        one.path.starts_with("racing.") || one.path.starts_with("program.") ||
        one.path.starts_with("command.") || one.path.starts_with("cases.") ||
        one.path.starts_with("identification.") || one.path.starts_with("excitation.") ||
        one.path.starts_with("motion.") || one.path.starts_with("tubes.") ||
        one.path == "objective.weights" || one.path == "objective.scales" ||
        one.path.find("[]") != std::string::npos || one.path == "control.bandwidth_hz" ||
        one.path == "control.delay_s" || one.path.starts_with("control.resolution_") ||
        one.path == "schedule.factor" || one.path == "objective.cvar_share" ||
        one.path == "objective.failure_penalty_m";
    // 0 is no density: it stands for a missing one.
    if (is_of_kind || one.setting->default_text.empty() || one.path == "robot.density_kg_per_m3") {
      continue;
    }
    const std::vector<std::string> overrides = {one.path + "=" + one.setting->default_text};
    EXPECT_NO_THROW(folder.load("base.toml", overrides)) << overrides[0];
  }
}

TEST(Settings, GainsAreThoseOfAllControllers) {
  const AnySetting& p = find(design_settings(), "joint[].p_n_m_per_rad");
  EXPECT_EQ(p.unit, "N m/rad");
  EXPECT_THAT(p.meaning, testing::StartsWith("gain of the controllers pid, "));
  for (const ControllerRow& controller : controller_table()) {
    for (const controllers::Gain& gain : controller.gains) {
      EXPECT_EQ(find(design_settings(), std::string("joint[].") + gain.key).unit, gain.unit);
    }
  }
}

}  // namespace
}  // namespace armwright
