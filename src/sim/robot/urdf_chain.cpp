// Finds the serial chain from the base to the tip in the tree of a URDF.

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>

#include "base/text.hpp"
#include "sim/robot/urdf.hpp"

namespace armwright {
namespace {

constexpr std::string_view kToolNames[] = {"tool", "tool0", "tcp", "tcp0", "ee", "eef", "flange"};

// Returns the first twelve names as text, and the number of the others.
std::string list_names(const std::vector<std::string>& names, std::string_view separator) {
  constexpr std::size_t kShown = 12;
  std::vector<std::string> shown;
  for (std::size_t i = 0; i < std::min(kShown, names.size()); ++i) {
    shown.push_back(fmt::format("'{}'", names[i]));
  }
  return join(shown, separator) +
         (names.size() > kShown ? fmt::format(" and {} more", names.size() - kShown) : "");
}

// Returns whether the name ends as those of frames at tools do: "tool0", "left_tcp", "ee_link".
bool is_tool_name(std::string name) {
  std::ranges::transform(name, name.begin(), [](unsigned char letter) {
    return static_cast<char>(std::tolower(letter));
  });
  for (const std::string_view ending : {"_link", "_frame"}) {
    if (name.ends_with(ending)) {
      name.resize(name.size() - ending.size());
    }
  }
  const std::string last = name.substr(name.find_last_of("_-/.") + 1);
  return name.ends_with("end_effector") ||
         std::ranges::find(kToolNames, last) != std::end(kToolNames);
}

// Returns whether the link exists only to be touched: it has no looks, and its name says so.
bool is_collision_helper(const UrdfLink& link) {
  return !link.has_visual && (link.name.ends_with("_sc") || link.name.ends_with("_collision"));
}

// The links and joints as a tree.
class Tree {
 public:
  Tree(const std::vector<UrdfLink>& links, const std::vector<UrdfJoint>& joints,
       const std::string& name)
      : links_(links), name_(name) {
    for (const UrdfJoint& joint : joints) {
      const auto [other, inserted] = joint_above_.emplace(joint.child, &joint);
      if (!inserted) {
        fail_urdf(name_, joint.line,
                  fmt::format("link '{}' is the child of the joints '{}' and '{}'; a link can have "
                              "only one parent joint",
                              joint.child, other->second->name, joint.name));
      }
      children_[joint.parent].push_back(joint.child);
    }
    find_root();
    check_cycles();
  }

  const UrdfLink& root() const { return *root_; }

  bool has(const std::string& link) const {
    return std::any_of(links_.begin(), links_.end(),
                       [&](const UrdfLink& other) { return other.name == link; });
  }

  std::set<std::string> find_all_below(const std::string& top) const {
    std::set<std::string> found{top};
    std::vector<std::string> open{top};
    while (!open.empty()) {
      const auto children = children_.find(open.back());
      open.pop_back();
      if (children != children_.end()) {
        for (const std::string& child : children->second) {
          if (found.insert(child).second) {
            open.push_back(child);
          }
        }
      }
    }
    return found;
  }

  std::vector<std::string> find_leaves(const std::string& top) const {
    const std::set<std::string> below = find_all_below(top);
    std::vector<std::string> leaves;
    for (const UrdfLink& link : links_) {
      if (below.contains(link.name) && !children_.contains(link.name)) {
        leaves.push_back(link.name);
      }
    }
    return leaves;
  }

  // Returns the joints from the root down to the link.
  std::vector<const UrdfJoint*> find_way(const std::string& link) const {
    std::vector<const UrdfJoint*> way;
    for (auto joint = joint_above_.find(link); joint != joint_above_.end();
         joint = joint_above_.find(joint->second->parent)) {
      way.push_back(joint->second);
    }
    std::reverse(way.begin(), way.end());
    return way;
  }

 private:
  void find_root() {
    for (const UrdfLink& link : links_) {
      if (joint_above_.contains(link.name)) {
        continue;
      }
      if (root_ != nullptr) {
        fail_urdf(
            name_, link.line,
            fmt::format("the links '{}' and '{}' both have no parent joint; exactly one link is "
                        "the root: connect them by a joint or remove one",
                        root_->name, link.name));
      }
      root_ = &link;
    }
    if (root_ == nullptr) {
      fail_urdf(name_, links_.front().line,
                fmt::format(
                    "the links form a cycle, {}; one link must be the root, without a parent joint",
                    describe_cycle(links_.front())));
    }
  }

  void check_cycles() const {
    const std::set<std::string> on_root = find_all_below(root_->name);
    for (const UrdfLink& link : links_) {
      if (!on_root.contains(link.name)) {
        fail_urdf(name_, link.line,
                  fmt::format(
                      "the links form a cycle, {}; joints must connect every link to the root '{}'",
                      describe_cycle(link), root_->name));
      }
    }
  }

  // Returns the cycle above a link that no root carries, as "'a' -> 'b' -> 'a'".
  std::string describe_cycle(const UrdfLink& start) const {
    // From such a link one can go up without end. So after as many steps as there are joints, the
    // link is on the cycle itself.
    std::string on_cycle = start.name;
    for (std::size_t i = 0; i < joint_above_.size(); ++i) {
      on_cycle = joint_above_.at(on_cycle)->parent;
    }
    std::string text = fmt::format("'{}'", on_cycle);
    std::string link = on_cycle;
    do {
      link = joint_above_.at(link)->parent;
      text = fmt::format("'{}' -> {}", link, text);
    } while (link != on_cycle);
    return text;
  }

  const std::vector<UrdfLink>& links_;
  const std::string& name_;
  const UrdfLink* root_ = nullptr;
  std::map<std::string, const UrdfJoint*> joint_above_;       // by child link
  std::map<std::string, std::vector<std::string>> children_;  // by parent link
};

class Chooser {
 public:
  Chooser(const std::vector<UrdfLink>& links, const Tree& tree, const RobotOptions& options,
          const std::string& name)
      : links_(links), tree_(tree), options_(options), name_(name) {}

  UrdfChain choose() const {
    UrdfChain chain;
    chain.base = options_.base.empty() ? tree_.root().name : find_link("base", options_.base);
    chain.ends = tree_.find_leaves(chain.base);
    chain.is_tip_proposed = options_.tip.empty() && chain.ends.size() > 1;
    chain.tip = options_.tip.empty() ? propose_tip(chain) : find_link("tip", options_.tip);
    const std::vector<const UrdfJoint*> way = tree_.find_way(chain.tip);
    auto first = way.begin();
    if (chain.base != tree_.root().name) {
      first = std::find_if(way.begin(), way.end(),
                           [&](const UrdfJoint* joint) { return joint->child == chain.base; });
      if (first == way.end()) {
        refuse_base(chain, way);
      }
      ++first;
    }
    for (; first != way.end(); ++first) {
      if ((*first)->type == "fixed") {
        continue;
      }
      if (chain.joints.empty()) {
        chain.moving_links = tree_.find_all_below((*first)->child);
        chain.carried_links = chain.moving_links;
      }
      chain.joints.emplace((*first)->name, (*first)->line);
      chain.carried_links.erase((*first)->child);
    }
    if (chain.joints.empty()) {
      fail_without_joint(chain);
    }
    return chain;
  }

 private:
  [[noreturn]] void fail(const std::string& option, const std::string& what,
                         const std::vector<std::string>& leaves = {}) const {
    throw RobotOptionError(option, fmt::format("{}: {}", name_, what), leaves);
  }

  std::string find_link(const std::string& option, const std::string& link) const {
    if (!tree_.has(link)) {
      std::vector<std::string> known;
      for (const UrdfLink& other : links_) {
        known.push_back(other.name);
      }
      fail(option, describe_unknown("link", sanitize(link), known));
    }
    return link;
  }

  // Returns the only leaf below the base, or the one that is clearly the tool.
  std::string propose_tip(const UrdfChain& chain) const {
    std::vector<std::string> left = chain.ends;
    const auto keep = [&left](const auto& is_kept) {
      if (left.size() > 1) {
        std::erase_if(left, [&](const std::string& leaf) { return !is_kept(leaf); });
      }
    };
    keep([&](const std::string& leaf) { return moves(chain.base, leaf); });
    keep([&](const std::string& leaf) {
      return std::ranges::none_of(links_, [&](const UrdfLink& link) {
        return link.name == leaf && is_collision_helper(link);
      });
    });
    keep(is_tool_name);
    if (left.size() != 1) {
      fail("tip",
           fmt::format("the links branch and end in {}; name the one whose frame is the tool "
                       "centre point (or any other link) with robot.tip or --tip",
                       list_names(chain.ends, ", ")),
           chain.ends);
    }
    return left.front();
  }

  // Returns whether a joint between the base and the link can move.
  bool moves(const std::string& base, const std::string& link) const {
    const std::vector<const UrdfJoint*> way = tree_.find_way(link);
    return std::any_of(way.rbegin(),
                       std::find_if(way.rbegin(), way.rend(),
                                    [&](const auto* joint) { return joint->child == base; }),
                       [](const UrdfJoint* joint) { return joint->type != "fixed"; });
  }

  [[noreturn]] void refuse_base(const UrdfChain& chain,
                                const std::vector<const UrdfJoint*>& way) const {
    const std::vector<const UrdfJoint*> above_base = tree_.find_way(chain.base);
    const bool is_tip_above =
        chain.tip == tree_.root().name || std::ranges::any_of(above_base, [&](const auto* joint) {
          return joint->child == chain.tip;
        });
    if (is_tip_above) {
      fail("tip",
           fmt::format(
               "the tip '{0}' is above the base '{1}' in the tree of links, and a chain runs "
               "down from its base to its tip; exchange them (--base {0} --tip {1}), or name "
               "a tip below the base",
               chain.tip, chain.base));
    }
    fail("base",
         fmt::format("the base '{}' is not above the tip '{}', and the path from the root to "
                     "the tip is {}; name one of these",
                     chain.base, chain.tip, describe_way(way)));
  }

  std::string describe_way(const std::vector<const UrdfJoint*>& way) const {
    std::vector<std::string> names{tree_.root().name};
    for (const UrdfJoint* joint : way) {
      names.push_back(joint->child);
    }
    return list_names(names, " -> ");
  }

  [[noreturn]] void fail_without_joint(const UrdfChain& chain) const {
    if (options_.base.empty() && options_.tip.empty()) {
      fail_urdf(name_, tree_.root().line,
                "the robot has no moving joint; it needs at least one revolute, continuous or "
                "prismatic joint");
    }
    fail(options_.tip.empty() ? "base" : "tip",
         fmt::format("no joint between the base '{}' and the tip '{}' moves; the chain needs at "
                     "least one revolute, continuous or prismatic joint",
                     chain.base, chain.tip));
  }

  const std::vector<UrdfLink>& links_;
  const Tree& tree_;
  const RobotOptions& options_;
  const std::string& name_;
};

}  // namespace

void add_choice(const UrdfChain& chain, RobotModel& model) {
  RobotReading& reading = model.reading;
  reading.base = chain.base;
  reading.tip = chain.tip;
  reading.ends = chain.ends;
  reading.is_tip_proposed = chain.is_tip_proposed;
  if (chain.is_tip_proposed) {
    std::vector<std::string> others = chain.ends;
    std::erase(others, chain.tip);
    model.notes.push_back(fmt::format(
        "the tip is taken to be '{}'; the other ends are {}; robot.tip or --tip names another",
        chain.tip, list_names(others, ", ")));
  }
}

std::string describe_held(const RobotModel& model, const std::string& joint,
                          const std::string& held_at, double mass_kg, std::size_t carrier) {
  return fmt::format(
      "joint '{}' is not between '{}' and '{}': held at {}, {} part of {}", joint,
      model.reading.base, model.reading.tip, held_at,
      mass_kg > 0 ? fmt::format("its {:.4g} kg are", mass_kg) : "what hangs on it is",
      carrier == 0 ? "the fixed base" : fmt::format("link '{}'", model.links[carrier - 1].name));
}

const UrdfLink& find_root(const std::vector<UrdfLink>& links, const std::vector<UrdfJoint>& joints,
                          const std::string& name) {
  return Tree(links, joints, name).root();
}

UrdfChain choose_chain(const std::vector<UrdfLink>& links, const std::vector<UrdfJoint>& joints,
                       const RobotOptions& options, const std::string& name) {
  const Tree tree(links, joints, name);
  return Chooser(links, tree, options, name).choose();
}

}  // namespace armwright
