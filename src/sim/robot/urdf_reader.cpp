// Makes a RobotModel of a URDF: joins links that do not move, and places joints and masses.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>

#include "base/error.hpp"
#include "base/text.hpp"
#include "sim/robot/assumed_mass.hpp"
#include "sim/robot/shape_mass.hpp"
#include "sim/robot/urdf.hpp"

namespace armwright {
namespace {

// Builds the model by walking down the tree. A link that does not move relative to a link of the
// chain becomes part of it.
class Builder {
 public:
  Builder(const CheckedUrdf& checked, const std::string& name, const RobotOptions& options,
          UrdfFaults& faults)
      : checked_(checked),
        name_(name),
        density_kg_per_m3_(options.density_kg_per_m3),
        repair_(options.repair),
        meshes_(std::filesystem::path(name).parent_path(), options.packages),
        faults_(faults) {
    model_.reading.packages = options.packages;
  }

  RobotModel build() {
    std::set<std::string> children;
    for (std::size_t i = 0; i < checked_.links.size(); ++i) {
      link_numbers_[checked_.links[i].name] = i;
    }
    for (std::size_t i = 0; i < checked_.joints.size(); ++i) {
      joints_below_[checked_.joints[i].parent][checked_.joints[i].name] = i;
      children.insert(checked_.joints[i].child);
    }
    const auto root = std::ranges::find_if(
        checked_.links, [&](const UrdfLink& link) { return !children.contains(link.name); });
    model_.name = checked_.name;
    model_.base.name = root->name;
    add(root->name, Eigen::Isometry3d::Identity(), 0, nullptr);
    model_.notes = checked_.notes;
    add_reading();
    if (repair_) {
      assume_missing_masses();
    }
    check_masses();
    std::ranges::sort(held_, {}, &Held::joint);  // in the order of the file
    for (const Held& held : held_) {
      model_.held_joints.push_back(checked_.joints[held.joint].name);
      model_.notes.push_back(describe_held(model_, checked_.joints[held.joint].name,
                                           checked_.placements[held.joint].held_at, held.mass_kg,
                                           held.carrier));
    }
    std::ranges::move(mass_notes_, std::back_inserter(model_.notes));
    std::ranges::move(mass_repairs_.list(), std::back_inserter(model_.reading.repairs));
    return std::move(model_);
  }

 private:
  // A held joint, and the mass of the links after it up to the next held joint.
  struct Held {
    std::size_t joint;
    std::size_t carrier;
    double mass_kg = 0;
  };

  // Body 0 is the base, body i the link that joint i - 1 moves.
  Link& get_body(std::size_t body) { return body == 0 ? model_.base : model_.links[body - 1]; }

  // Adds a link and everything below it, joints in the order of their names. `pose` is the link's
  // in its carrier's frame. Recurses at most kUrdfLinkLimit deep.
  void add(const std::string& link, const Eigen::Isometry3d& pose, std::size_t carrier,
           const std::size_t* held) {
    lump(link, pose, carrier, held);
    if (link == checked_.chain.tip) {
      model_.tip_pose = pose;
    }
    const auto below = joints_below_.find(link);
    if (below == joints_below_.end()) {
      return;
    }
    for (const auto& [name, number] : below->second) {
      const std::string& child = checked_.joints[number].child;
      const UrdfPlacement& placement = checked_.placements[number];
      if (checked_.chain.joints.contains(name)) {
        Joint joint = placement.motion;
        joint.origin = pose * placement.origin;
        model_.joints.push_back(std::move(joint));
        model_.links.emplace_back().name = child;
        add(child, Eigen::Isometry3d::Identity(), model_.links.size(), nullptr);
      } else if (!placement.held_at.empty()) {
        const std::size_t own = held_.size();
        held_.push_back({number, carrier});
        add(child, pose * placement.origin * placement.held_pose, carrier, &own);
      } else {
        add(child, pose * placement.origin, carrier, held);
      }
    }
  }

  void add_reading() {
    model_.reading.repairs = checked_.repairs.list();
    add_choice(checked_.chain, model_);
  }

  void assume_missing_masses() {
    for (const std::size_t i : assume_masses(model_, mass_notes_)) {
      const Link& link = model_.links[i];
      model_.reading.assumed_links.push_back(link.name);
      add_inertial(link.name, link.inertial);
    }
  }

  // Notes that a link of the file needs this <inertial>.
  void add_inertial(const std::string& link, const Inertial& body) {
    if (!repair_) {
      return;
    }
    const std::size_t number = link_numbers_.at(link);
    const std::size_t zeros = checked_.bodies[number].zero_inertial;
    const UrdfEdit edit = zeros != 0
                              ? UrdfEdit{zeros, UrdfEdit::Kind::replace, write_inertial(body)}
                              : UrdfEdit{checked_.links[number].element, UrdfEdit::Kind::append,
                                         write_inertial(body)};
    mass_repairs_.add("a moving link without <inertial> gets one", fmt::format("'{}'", link),
                      {edit});
  }

  // Adds a link's mass and visual shapes to the body that carries it.
  void lump(const std::string& link, const Eigen::Isometry3d& pose, std::size_t carrier,
            const std::size_t* held) {
    const UrdfBody& from = checked_.bodies[link_numbers_.at(link)];
    Link& body = get_body(carrier);
    Inertial inertial;
    if (from.inertial) {
      inertial = *from.inertial;
    } else if (carrier > 0 && from.has_faults) {
      inertial.mass_kg = 1;  // so that it is not reported as missing; the robot is refused
    } else if (density_kg_per_m3_ > 0 && carrier > 0 &&
               !(from.shapes.empty() && from.unshown.empty())) {
      if (!faults_.attempt([&] { inertial = calc_inertial(link, from); })) {
        inertial.mass_kg = 1;
      }
    }
    if (inertial.mass_kg > 0) {
      body.inertial = combine(body.inertial, transform(inertial, pose));
    }
    if (held != nullptr) {
      held_[*held].mass_kg += inertial.mass_kg;
    }
    for (const VisualShape& shape : from.shapes) {
      body.visuals.push_back(shape);
      body.visuals.back().pose = pose * shape.pose;
    }
  }

  // Returns the mass properties of a link's shapes at the density, in the link's frame.
  Inertial calc_inertial(const std::string& link, const UrdfBody& from) {
    const int line = checked_.links[link_numbers_.at(link)].line;
    const auto fail = [&](const std::string& what) {
      throw UrdfFault(line, fmt::format("{}: link '{}': {}", name_, link, what), what);
    };
    if (!from.unshown.empty()) {
      fail(
          fmt::format("its mass comes from its <visual> elements, and one of them has none ({}); "
                      "correct it, or give the link an <inertial> element",
                      from.unshown));
    }
    Inertial sum;
    for (const VisualShape& shape : from.shapes) {
      try {
        const ShapeMass mass = calc_shape_mass(shape, density_kg_per_m3_, meshes_);
        sum = combine(sum, mass.inertial);
        if (mass.file) {
          model_.mass_files[shape.mesh_file] = *mass.file;
        }
        if (!mass.note.empty()) {
          mass_notes_.push_back(fmt::format("link '{}': {}", link, mass.note));
        }
      } catch (const Error& error) {
        fail(error.what());
      }
    }
    mass_notes_.push_back(fmt::format(
        "link '{}' has no <inertial>: {:.4g} kg and their inertia come from its {} at {} kg/m3",
        link, sum.mass_kg,
        from.shapes.size() == 1 ? "shape" : fmt::format("{} shapes", from.shapes.size()),
        density_kg_per_m3_));
    model_.reading.density_kg_per_m3 = density_kg_per_m3_;
    add_inertial(link, sum);
    return sum;
  }

  void check_masses() const {
    for (std::size_t i = 0; i < model_.links.size(); ++i) {
      const Link& link = model_.links[i];
      if (link.inertial.mass_kg > 0) {
        continue;
      }
      const std::string& joint = model_.joints[i].name;
      faults_.attempt([&] {
        fail_urdf(
            name_, checked_.chain.joints.at(joint),
            fmt::format("joint '{}' moves link '{}', which has no mass{}; give it an "
                        "<inertial> element{} (or make the joint fixed)",
                        joint, link.name,
                        density_kg_per_m3_ > 0 ? " and no <visual> to take it from" : "",
                        density_kg_per_m3_ > 0
                            ? ""
                            : ", or set robot.density_kg_per_m3 to take it from the shapes of "
                              "its <visual> elements"));
      });
    }
  }

  const CheckedUrdf& checked_;
  std::map<std::string, std::size_t> link_numbers_;
  std::map<std::string, std::map<std::string, std::size_t>>
      joints_below_;  // by parent link and name
  const std::string& name_;
  double density_kg_per_m3_;
  bool repair_;
  MeshFinder meshes_;
  UrdfFaults& faults_;
  RobotModel model_;
  std::vector<Held> held_;
  std::vector<std::string> mass_notes_;
  UrdfRepairs mass_repairs_;
};

bool has_massless_link(const RobotModel& model) {
  return std::ranges::any_of(model.links,
                             [](const Link& link) { return link.inertial.mass_kg == 0; });
}

}  // namespace

RobotModel build_model(const CheckedUrdf& checked, const std::string& name,
                       const RobotOptions& options, UrdfFaults& faults) {
  RobotOptions tried = options;
  if (options.repair && options.mass_from_shapes && options.density_kg_per_m3 == 0) {
    tried.repair = false;
    UrdfFaults ignored(name);
    if (has_massless_link(Builder(checked, name, tried, ignored).build())) {
      // All masses come from shapes, or none: links of one arm are then comparable.
      tried = options;
      tried.density_kg_per_m3 = kRepairDensity_kg_per_m3;
      UrdfFaults of_shapes(name);
      RobotModel model = Builder(checked, name, tried, of_shapes).build();
      if (of_shapes.count() == 0 && model.reading.assumed_links.empty()) {
        return model;
      }
    }
  }
  return Builder(checked, name, options, faults).build();
}

}  // namespace armwright
