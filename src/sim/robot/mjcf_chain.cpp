// Finds the chain in a compiled MJCF file, and refuses what acts on it and is not simulated.

#ifdef ARMWRIGHT_WITH_MUJOCO

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "base/text.hpp"
#include "sim/robot/mjcf_parts.hpp"
#include "sim/robot/urdf.hpp"

namespace armwright {
namespace {

class ChainChooser {
 public:
  ChainChooser(const CompiledMjcf& mjcf, const RobotOptions& options)
      : mjcf_(mjcf), model_(*mjcf.model), options_(options) {}

  MjcfChain choose() {
    choose_ends();
    for (int body = chain_.tip; body != chain_.base; body = model_.body_parentid[body]) {
      if (model_.body_jntnum[body] > 0) {
        check_joints(body);
        chain_.joints.push_back(model_.body_jntadr[body]);
      }
    }
    std::ranges::reverse(chain_.joints);
    chain_.carriers.assign(to_size(model_.nbody), 0);
    for (int body = 1; body < model_.nbody; ++body) {  // parents come first
      const auto moved = std::ranges::find(chain_.joints, model_.body_jntadr[body]);
      chain_.carriers[to_size(body)] =
          model_.body_jntnum[body] > 0 && moved != chain_.joints.end()
              ? static_cast<std::size_t>(moved - chain_.joints.begin()) + 1
              : chain_.carriers[to_size(model_.body_parentid[body])];
    }
    check_equalities();
    check_tendons();
    return std::move(chain_);
  }

 private:
  // Bodies are the links, and sites can be named in their place. Bodies that stand beside the
  // robot, without a joint above or below, are no links: a floor, a table.
  void choose_ends() {
    std::vector<char> has_joint(to_size(model_.nbody), 0);  // above, in it or below
    for (int body = 1; body < model_.nbody; ++body) {       // parents come first
      has_joint[to_size(body)] =
          model_.body_jntnum[body] > 0 || has_joint[to_size(model_.body_parentid[body])] != 0;
    }
    for (int body = model_.nbody - 1; body > 0; --body) {
      if (has_joint[to_size(body)] != 0) {
        has_joint[to_size(model_.body_parentid[body])] = 1;
      }
    }
    std::vector<UrdfLink> links = {{mjcf_.body_name(0), 1}};
    std::vector<UrdfJoint> joints;
    for (int body = 1; body < model_.nbody; ++body) {
      if (has_joint[to_size(body)] == 0) {
        continue;
      }
      const std::string name = mjcf_.body_name(body);
      links.push_back({name, 1});
      const bool is_fixed = model_.body_jntnum[body] == 0;
      joints.push_back({is_fixed ? name : mjcf_.joint_name(model_.body_jntadr[body]),
                        mjcf_.body_name(model_.body_parentid[body]), name,
                        is_fixed ? "fixed" : "revolute", 1});
    }
    RobotOptions by_body = options_;
    const auto replace_site = [&](std::string& link) {
      if (link.empty() || mj_name2id(&model_, mjOBJ_BODY, link.c_str()) >= 0) {
        return -1;
      }
      const int site = mj_name2id(&model_, mjOBJ_SITE, link.c_str());
      if (site >= 0) {
        link = mjcf_.body_name(model_.site_bodyid[site]);
      }
      return site;
    };
    replace_site(by_body.base);
    chain_.site = replace_site(by_body.tip);
    chain_.choice = choose_chain(links, joints, by_body, mjcf_.name);
    chain_.base = find_body(chain_.choice.base);
    chain_.tip = find_body(chain_.choice.tip);
    if (chain_.site >= 0) {
      chain_.choice.tip = options_.tip;
    }
  }

  int find_body(const std::string& name) const {
    for (int body = 0; body < model_.nbody; ++body) {
      if (mjcf_.body_name(body) == name) {
        return body;
      }
    }
    return 0;  // never: choose_chain() returns one of the names
  }

  std::string describe_chain() const {
    return fmt::format("between base '{}' and tip '{}'", mjcf_.body_name(chain_.base),
                       mjcf_.body_name(chain_.tip));
  }

  // Checks the joints of a body of the chain.
  void check_joints(int body) const {
    const int first = model_.body_jntadr[body];
    for (int joint = first; joint < first + model_.body_jntnum[body]; ++joint) {
      const int type = model_.jnt_type[joint];
      if (type != mjJNT_HINGE && type != mjJNT_SLIDE) {
        mjcf_.fail_joint(
            joint, fmt::format("its type is {}; {} only hinge and slide joints are simulated: name "
                               "a base below it (robot.base or --base), such as '{}'",
                               type == mjJNT_FREE ? "free" : "ball", describe_chain(),
                               mjcf_.body_name(body)));
      }
    }
    if (model_.body_jntnum[body] > 1) {
      mjcf_.fail_joint(first + 1, fmt::format("is the second joint of body '{}'; {} each joint "
                                              "needs a body with a mass of its own: put a body "
                                              "with an <inertial> between the joints, or name a "
                                              "base below them (robot.base or --base)",
                                              mjcf_.body_name(body), describe_chain()));
    }
  }

  bool is_in_chain(int joint) const {
    return std::ranges::find(chain_.joints, joint) != chain_.joints.end();
  }

  [[noreturn]] void refuse(const std::vector<MjcfPlace>& places, int number,
                           const std::string& what) const {
    const MjcfPlace place =
        to_size(number) < places.size() ? places[to_size(number)] : MjcfPlace{mjcf_.name};
    fail_urdf(place.file, place.line,
              fmt::format("{} acts on the chain {}, which is not simulated: remove it, or name "
                          "another base or tip (robot.base, robot.tip, --base, --tip)",
                          what, describe_chain()));
  }

  void check_equalities() const {
    for (int number = 0; number < model_.neq; ++number) {
      const int first = model_.eq_obj1id[number];
      const int second = model_.eq_obj2id[number];
      const auto carry = [&](int body) { return body < 0 ? 0 : chain_.carriers[to_size(body)]; };
      bool acts = false;
      switch (model_.eq_type[number]) {
        case mjEQ_CONNECT:
        case mjEQ_WELD:
          acts = carry(first) != carry(second);
          break;
        case mjEQ_JOINT:
          acts = is_in_chain(first) || (second >= 0 && is_in_chain(second));
          break;
        case mjEQ_DISTANCE:
          acts = carry(model_.geom_bodyid[first]) != carry(model_.geom_bodyid[second]);
          break;
        default:  // constraints of tendons; check_tendons() refuses those of the chain
          break;
      }
      if (acts && model_.eq_active[number] != 0) {
        refuse(mjcf_.text.equalities, number, "this equality constraint");
      }
    }
  }

  void check_tendons() const {
    for (int tendon = 0; tendon < model_.ntendon; ++tendon) {
      std::set<std::size_t> carriers;  // at least two: the tendon's length depends on the chain
      for (int i = 0; i < model_.tendon_num[tendon]; ++i) {
        const int wrap = model_.tendon_adr[tendon] + i;
        const int object = model_.wrap_objid[wrap];
        switch (model_.wrap_type[wrap]) {
          case mjWRAP_JOINT:
            if (is_in_chain(object)) {
              carriers.insert({0, 1});
            }
            break;
          case mjWRAP_SITE:
            carriers.insert(chain_.carriers[to_size(model_.site_bodyid[object])]);
            break;
          case mjWRAP_SPHERE:
          case mjWRAP_CYLINDER:
            carriers.insert(chain_.carriers[to_size(model_.geom_bodyid[object])]);
            break;
          default:  // a pulley
            break;
        }
      }
      if (carriers.size() > 1) {
        refuse(mjcf_.text.tendons, tendon, "this tendon");
      }
    }
  }

  const CompiledMjcf& mjcf_;
  const mjModel& model_;
  const RobotOptions& options_;
  MjcfChain chain_;
};

}  // namespace

MjcfChain choose_mjcf_chain(const CompiledMjcf& mjcf, const RobotOptions& options) {
  return ChainChooser(mjcf, options).choose();
}

}  // namespace armwright

#endif
