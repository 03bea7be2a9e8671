#include <fmt/format.h>

#include <map>

#include "base/error.hpp"
#include "base/text.hpp"
#include "sim/urdf.hpp"

namespace armwright {
namespace {

// "'a' -> 'b' -> 'a'": follows the joints down from a link that has no root above it.
std::string describe_cycle(const UrdfLink& start,
                           const std::map<std::string, const UrdfJoint*>& joint_above) {
  // Going up never ends on such a link, so after as many steps as there are joints we are on the
  // cycle itself.
  std::string on_cycle = start.name;
  for (std::size_t i = 0; i < joint_above.size(); ++i) {
    on_cycle = joint_above.at(on_cycle)->parent;
  }
  std::string text = fmt::format("'{}'", on_cycle);
  std::string link = on_cycle;
  do {
    link = joint_above.at(link)->parent;
    text = fmt::format("'{}' -> {}", link, text);
  } while (link != on_cycle);
  return text;
}

}  // namespace

void check_urdf_chain(const std::vector<UrdfLink>& links, const std::vector<UrdfJoint>& joints,
                      const std::string& name) {
  std::map<std::string, const UrdfJoint*> joint_above;                // by child link
  std::map<std::string, std::vector<const UrdfJoint*>> joints_below;  // by parent link
  for (const UrdfJoint& joint : joints) {
    const auto [other, inserted] = joint_above.emplace(joint.child, &joint);
    if (!inserted) {
      fail_urdf(name, joint.line,
                fmt::format(
                    "link '{}' is the child of the joints '{}' and '{}'; a link hangs on one joint",
                    joint.child, other->second->name, joint.name));
    }
    joints_below[joint.parent].push_back(&joint);
  }

  const UrdfLink* root = nullptr;
  std::map<std::string, const UrdfLink*> link_by_name;
  for (const UrdfLink& link : links) {
    link_by_name[link.name] = &link;
    if (joint_above.contains(link.name)) {
      continue;
    }
    if (root != nullptr) {
      fail_urdf(name, link.line,
                fmt::format("the links '{}' and '{}' both hang on no joint; exactly one link is "
                            "the root: join them by a "
                            "joint or remove one",
                            root->name, link.name));
    }
    root = &link;
  }
  if (root == nullptr) {
    fail_urdf(
        name, links.front().line,
        fmt::format("the links form a cycle, {}; one link must be the root that hangs on no joint",
                    describe_cycle(links.front(), joint_above)));
  }

  const UrdfLink* link = root;
  const UrdfJoint* carrying = nullptr;  // the last moving joint so far
  bool carries_mass = true;
  std::size_t visited = 1;
  const auto check_mass = [&] {
    if (!carries_mass) {
      fail_urdf(
          name, carrying->line,
          fmt::format(
              "joint '{}' moves link '{}', which has no mass; give it an <inertial> element (or "
              "make the joint fixed)",
              carrying->name, carrying->child));
    }
  };
  while (joints_below.contains(link->name)) {
    const auto& below = joints_below.at(link->name);
    if (below.size() > 1) {
      fail_urdf(name, below[1]->line,
                fmt::format("link '{}' carries the joints '{}' and '{}'; the robot must be a "
                            "single chain without "
                            "branches: remove the one that does not lead to the tool",
                            link->name, below[0]->name, below[1]->name));
    }
    const UrdfJoint& joint = *below.front();
    link = link_by_name.at(joint.child);
    ++visited;
    if (joint.moving) {
      check_mass();
      carrying = &joint;
      carries_mass = false;
    }
    carries_mass = carries_mass || link->has_mass;
  }
  for (const UrdfLink& other : links) {
    const UrdfLink* top = &other;
    for (std::size_t i = 0;
         visited < links.size() && top != root && joint_above.contains(top->name); ++i) {
      if (i > links.size()) {
        fail_urdf(name, other.line,
                  fmt::format("the links form a cycle, {}; every link must hang on the root '{}'",
                              describe_cycle(other, joint_above), root->name));
      }
      top = link_by_name.at(joint_above.at(top->name)->parent);
    }
  }
  if (carrying == nullptr) {
    fail_urdf(name, root->line,
              "the robot has no moving joint; it needs at least one revolute, continuous or "
              "prismatic joint");
  }
  check_mass();
}

}  // namespace armwright
