// The shipped designs: those of the thesis, against what it prints, and our own, against what made
// them; design files are read back as they were written.
#include <gmock/gmock.h>

#include <bit>
#include <filesystem>
#include <fstream>
#include <map>

#include "base/temporary_folder.hpp"
#include "problems/config/config_files.hpp"
#include "problems/config/design_file.hpp"
#include "problems/config/problem_loader.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;
using testing::UnorderedElementsAre;

const std::filesystem::path kReferenceDesigns = ARMWRIGHT_CONFIGS "/../results/reference/designs";

std::string read_bytes(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  EXPECT_TRUE(stream) << path;
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(ShippedDesigns, HaveTheTotalTorqueOfTheThesis) {
  // Table 6.4 and section 6.4.1 print whole newton metres.
  const std::map<std::string, double> published = {
      {"table-a1", 85200}, {"table-a5", 963686}, {"table-a10", 28927}, {"table-a11", 21603}};
  for (const auto& [name, torque] : published) {
    EXPECT_NEAR(calc_total_effort(load_design(name).design), torque, 0.5) << name;
  }
  EXPECT_EQ(calc_total_effort(load_design("table-a1").design), 85200);
}

constexpr const char* kStartOfIrb4600 = "irb4600-start";

std::vector<std::string> list_designs(bool of_the_thesis) {
  std::vector<std::string> names = list_configs("designs");
  std::erase_if(names, [&](const std::string& name) {
    return name == kStartOfIrb4600 || name.starts_with("table-") != of_the_thesis;
  });
  return names;
}

TEST(ShippedDesigns, AreThoseOfTheAppendixForThisArm) {
  const std::vector<std::string> names = list_designs(true);
  EXPECT_THAT(names, UnorderedElementsAre("table-a1", "table-a5", "table-a6", "table-a7",
                                          "table-a8", "table-a9", "table-a10", "table-a11"));
  for (const std::string& name : names) {
    SCOPED_TRACE(name);
    const DesignFile file = load_design(name);
    EXPECT_EQ(file.name, name);
    EXPECT_THAT(file.title, testing::Not(IsEmpty()));
    EXPECT_EQ(file.source, "thesis, Table A." + name.substr(7));
    EXPECT_EQ(file.design.controller, "pid");
    EXPECT_THAT(file.joint_names, ElementsAre("joint_1", "joint_2", "joint_3", "joint_4"));
    load_problem("q1-complex").tracking()->check_design(file.design);
    for (const JointDrive& joint : file.design.joints) {
      EXPECT_THAT(joint.gains, SizeIs(3));
      EXPECT_LT(joint.limits.min, 0);
      EXPECT_GT(joint.limits.max, 0);
    }
  }
}

TEST(ShippedDesigns, OfOurOwnAreThoseOfTheReferenceStudy) {
  for (const std::string& name : list_designs(false)) {
    SCOPED_TRACE(name);
    EXPECT_EQ(read_bytes(find_config_folder() / "designs" / (name + ".toml")),
              read_bytes(kReferenceDesigns / (name + ".toml")));
    const DesignFile file = load_design(name);
    EXPECT_EQ(file.name, name);
    EXPECT_THAT(file.source, testing::StartsWith("armwright optimize "));
    EXPECT_THAT(file.joint_names, ElementsAre("joint_1", "joint_2", "joint_3", "joint_4"));
  }
  std::size_t made = 0;
  for (const auto& file : std::filesystem::directory_iterator(kReferenceDesigns)) {
    made += file.path().extension() == ".toml" ? 1 : 0;
  }
  EXPECT_EQ(list_designs(false).size(), made);
}

// As its file says: the gains are rounded to three digits. The effort limits are twice the peak, where
// a proposal leaves more room below those of the URDF.
TEST(ShippedDesigns, TheStartOfIrb4600IsProposedForItsPlant) {
  const LoadedProblem proposed = load_problem(
      "irb4600", std::vector<std::string>{"variables.start=proposed", "task.load_kg=40",
                                          "variables.start_bandwidth_rad_per_s=66.7"});
  const ArmDesign& expected = proposed.tracking()->config().start;
  const ArmDesign own = load_design(kStartOfIrb4600).design;
  const ArmDesign start = load_problem("irb4600").tracking()->config().start;
  ASSERT_EQ(own.joints.size(), expected.joints.size());
  for (std::size_t i = 0; i < own.joints.size(); ++i) {
    SCOPED_TRACE(i);
    ASSERT_THAT(own.joints[i].gains, SizeIs(3));
    EXPECT_EQ(start.joints[i].gains, own.joints[i].gains);
    for (std::size_t k = 0; k < 3; ++k) {
      const double gain = expected.joints[i].gains[k];
      EXPECT_NEAR(own.joints[i].gains[k], gain, 0.005 * gain);
    }
    EXPECT_LT(own.joints[i].limits.max, expected.joints[i].limits.max);
  }
}

TEST(ShippedDesigns, PublishedResultsNameProblemsThatLoad) {
  std::vector<std::string> labels;
  for (const std::string& name : list_configs("designs")) {
    for (const PublishedResult& published : load_design(name).published) {
      SCOPED_TRACE(published.label);
      labels.push_back(published.label);
      const LoadedProblem loaded = load_problem(published.problem, published.overrides);
      ASSERT_NE(loaded.tracking(), nullptr);
      EXPECT_THAT(published.where, testing::Not(IsEmpty()));
      if (published.overrides.empty()) {  // the design is the problem's winner
        EXPECT_EQ(loaded.published.design, name);
        EXPECT_EQ(loaded.published.error_m, published.error_m);
      }
      if (published.total_torque_n_m) {
        EXPECT_NEAR(calc_total_effort(load_design(name).design), *published.total_torque_n_m, 0.5);
      }
    }
  }
  EXPECT_THAT(labels, UnorderedElementsAre("A.5", "A.5, IK bug off", "A.6", "A.7", "A.8", "A.9",
                                           "A.10 (E6)", "A.10 with the 20 kg load", "A.11 (Q3)"));
}

TEST(ShippedDesigns, OverridesOfPublishedResultsTakeEffect) {
  const auto load = [](const std::string& design, std::size_t which) {
    const PublishedResult published = load_design(design).published.at(which);
    return load_problem(published.problem, published.overrides).tracking()->config().task;
  };
  EXPECT_TRUE(load("table-a5", 0).ik_bug);
  EXPECT_FALSE(load("table-a5", 1).ik_bug);
  EXPECT_EQ(load("table-a10", 0).load_kg, 0);
  EXPECT_EQ(load("table-a10", 1).load_kg, 20);
  EXPECT_EQ(load_design("table-a10").published.at(1).error_m, 0.2699);  // thesis, Fig. 6.15
}

void expect_same_bits(const ArmDesign& a, const ArmDesign& b) {
  const auto get_bits = [](const ArmDesign& design) {
    std::vector<std::uint64_t> bits;
    for (const JointDrive& joint : design.joints) {
      for (const double gain : joint.gains) {
        bits.push_back(std::bit_cast<std::uint64_t>(gain));
      }
      bits.push_back(std::bit_cast<std::uint64_t>(joint.limits.min));
      bits.push_back(std::bit_cast<std::uint64_t>(joint.limits.max));
    }
    return bits;
  };
  EXPECT_EQ(a.controller, b.controller);
  EXPECT_EQ(get_bits(a), get_bits(b));
}

DesignFile write_and_load(const DesignFile& file) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "written.toml";
  std::ofstream(path, std::ios::binary) << to_toml(file);
  return load_design(path.string());
}

TEST(DesignFiles, AreReadBackBitForBit) {
  for (const std::string& name : list_configs("designs")) {
    SCOPED_TRACE(name);
    const DesignFile file = load_design(name);
    const DesignFile again = write_and_load(file);
    expect_same_bits(again.design, file.design);
    EXPECT_EQ(again.name, file.name);
    EXPECT_EQ(again.title, file.title);
    EXPECT_EQ(again.source, file.source);
    EXPECT_EQ(again.joint_names, file.joint_names);
    EXPECT_THAT(again.published, IsEmpty());
  }
}

TEST(DesignFiles, KeepNumbersThatNoShortDecimalHolds) {
  DesignFile file = load_design("table-a1");
  file.design.joints[0] = {{0.1 + 0.2, 1.0 / 3, 5e-324}, {-1e300, 123456789.123456789}};
  file.design.joints[1] = {{1e15, 1e16, 9007199254740993e3}, {-0.5, 1.7976931348623157e308}};
  file.design.joints[2] = {{2.2250738585072014e-308, 1e22, 4e18}, {0, 0}};
  expect_same_bits(write_and_load(file).design, file.design);
}

TEST(DesignFiles, KeepTextsThatNeedQuoting) {
  DesignFile file = load_design("table-a1");
  file.title = "\"quoted\" \\ back\\slash # no comment\nsecond line\ttab \x1b[31m \x7f";
  file.source = "Müller, Tabelle 3 – 20 °C";
  file.joint_names[0] = "'''";
  const DesignFile again = write_and_load(file);
  EXPECT_EQ(again.title, file.title);
  EXPECT_EQ(again.source, file.source);
  EXPECT_EQ(again.joint_names, file.joint_names);
}

}  // namespace
}  // namespace armwright
