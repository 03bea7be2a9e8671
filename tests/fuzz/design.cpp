// Design files: what load_design() accepts is written and read back bit for bit.
#include <algorithm>

#include "fuzz/harness.hpp"
#include "problems/config/design_file.hpp"

namespace armwright::fuzz {
namespace {

DesignFile load(std::string_view text) {
  const auto file = get_scratch_folder("design") / "design.toml";
  write_scratch(file, text);
  return load_design(file.string());
}

bool same(const ArmDesign& a, const ArmDesign& b) {
  return a.controller == b.controller && a.speed_m_per_s == b.speed_m_per_s &&
         std::ranges::equal(a.joints, b.joints, [](const JointDrive& one, const JointDrive& other) {
           return one.gains == other.gains && one.limits.min == other.limits.min &&
                  one.limits.max == other.limits.max && one.length_scale == other.length_scale &&
                  one.section_scale == other.section_scale && one.tube == other.tube;
         });
}

}  // namespace

void fuzz_design(std::string_view input) {
  is_read([&] {
    const DesignFile design = load(input);
    const std::string text = to_toml(design);
    const DesignFile again = [&] {
      try {
        return load(text);
      } catch (const Error& error) {
        throw BrokenPromise(std::string("a design is not read back: ") + error.what());
      }
    }();
    require(same(again.design, design.design) && again.joint_names == design.joint_names,
            "another design is read back");
    require(
        again.name == design.name && again.title == design.title && again.source == design.source,
        "another name is read back");
    require(to_toml(again) == text, "the design is written otherwise");
  });
}

}  // namespace armwright::fuzz
