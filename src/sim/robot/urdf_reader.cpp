#include <console_bridge/console.h>
#include <fmt/format.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <limits>
#include <mutex>
#include <optional>

#include "base/error.hpp"
#include "base/text.hpp"
#include "sim/robot/shape_mass.hpp"
#include "sim/robot/urdf.hpp"

namespace armwright {
namespace {

// urdfdom explains itself through console_bridge only, whose handler is one for the whole process:
// ours collects the errors and keeps everything off the terminal.
class ErrorCollector final : public console_bridge::OutputHandler {
 public:
  ErrorCollector() : previous_(console_bridge::getOutputHandler()) {
    console_bridge::useOutputHandler(this);
  }
  ~ErrorCollector() override {
    if (previous_ != nullptr) {
      console_bridge::useOutputHandler(previous_);
    } else {
      console_bridge::noOutputHandler();
    }
  }
  ErrorCollector(const ErrorCollector&) = delete;
  ErrorCollector& operator=(const ErrorCollector&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR) {
      errors_.push_back(sanitize(text));
    }
  }
  std::string text() const { return errors_.empty() ? "no reason given" : join(errors_, "; "); }

 private:
  console_bridge::OutputHandler* previous_;
  std::vector<std::string> errors_;
};

urdf::ModelInterfaceSharedPtr parse_with_urdfdom(const std::string& xml, const std::string& name) {
  static std::mutex one_handler;
  const std::lock_guard lock(one_handler);
  const ErrorCollector collector;
  std::string reason;
  try {
    if (auto model = urdf::parseURDF(xml)) {
      return model;
    }
    reason = collector.text();
  } catch (const std::exception& error) {
    reason = sanitize(error.what());
  }
  throw Error(ErrorKind::bad_data,
              fmt::format("{}: the URDF library refuses it: {}", name, reason));
}

Eigen::Vector3d to_eigen(const urdf::Vector3& v) {
  return {v.x, v.y, v.z};
}

Eigen::Isometry3d to_eigen(const urdf::Pose& pose) {
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.translation() = to_eigen(pose.position);
  const urdf::Rotation& r = pose.rotation;
  result.linear() = Eigen::Quaterniond(r.w, r.x, r.y, r.z).toRotationMatrix();
  return result;
}

Inertial to_inertial(const urdf::Inertial& from) {
  Inertial body{from.mass, Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero()};
  body.inertia_kg_m2 << from.ixx, from.ixy, from.ixz,  //
      from.ixy, from.iyy, from.iyz,                    //
      from.ixz, from.iyz, from.izz;
  return transform(body, to_eigen(from.origin));
}

VisualShape to_shape(const urdf::Visual& visual) {
  VisualShape shape;
  shape.pose = to_eigen(visual.origin);
  if (visual.material) {
    const urdf::Color& color = visual.material->color;
    shape.rgba = Eigen::Vector4d(color.r, color.g, color.b, color.a);
  }
  if (const auto* box = dynamic_cast<const urdf::Box*>(visual.geometry.get())) {
    shape.kind = ShapeKind::box;
    shape.size_m = to_eigen(box->dim);
  } else if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(visual.geometry.get())) {
    shape.kind = ShapeKind::cylinder;
    shape.size_m = Eigen::Vector3d(cylinder->radius, cylinder->length, 0);
  } else if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(visual.geometry.get())) {
    shape.kind = ShapeKind::sphere;
    shape.size_m = Eigen::Vector3d(sphere->radius, 0, 0);
  } else if (const auto* mesh = dynamic_cast<const urdf::Mesh*>(visual.geometry.get())) {
    shape.kind = ShapeKind::mesh;
    shape.size_m = to_eigen(mesh->scale);
    shape.mesh_file = mesh->filename;
  }
  return shape;
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// 0 stands for none.
double to_limit(double value) {
  return value == 0 ? kInfinity : value;
}

Joint to_joint(const urdf::Joint& from, const Eigen::Isometry3d& parent_pose) {
  const bool continuous = from.type == urdf::Joint::CONTINUOUS;
  Joint joint;
  joint.name = from.name;
  joint.kind = from.type == urdf::Joint::PRISMATIC ? JointKind::prismatic : JointKind::revolute;
  joint.origin = parent_pose * to_eigen(from.parent_to_joint_origin_transform);
  joint.axis = to_eigen(from.axis).normalized();
  joint.lower = continuous ? -kInfinity : from.limits->lower;
  joint.upper = continuous ? kInfinity : from.limits->upper;
  joint.speed_limit = from.limits ? to_limit(from.limits->velocity) : kInfinity;
  joint.effort_limit = from.limits ? to_limit(from.limits->effort) : kInfinity;
  return joint;
}

// Walks down the tree; what does not move against a link of the chain becomes part of it.
class Builder {
 public:
  Builder(const CheckedUrdf& checked, const std::string& name, const RobotOptions& options)
      : checked_(checked),
        name_(name),
        density_kg_per_m3_(options.density_kg_per_m3),
        folder_(std::filesystem::path(name).parent_path()) {}

  RobotModel build(const urdf::ModelInterface& from) {
    model_.name = from.getName();
    model_.base.name = from.getRoot()->name;
    add(*from.getRoot(), Eigen::Isometry3d::Identity(), 0, nullptr);
    check_masses();
    model_.notes = checked_.notes;
    std::ranges::stable_sort(held_, {}, [this](const Held& held) {  // as in the file
      return checked_.held.at(held.joint).line;
    });
    for (const Held& held : held_) {
      model_.notes.push_back(describe(held));
    }
    for (std::string& note : mass_notes_) {
      model_.notes.push_back(std::move(note));
    }
    return std::move(model_);
  }

 private:
  // A joint that is held, and what hangs on it up to the next such joint.
  struct Held {
    std::string joint;
    std::size_t carrier;
    double mass_kg = 0;
  };

  // Body 0 is the base, body i the link that joint i - 1 moves.
  Link& get_body(std::size_t body) { return body == 0 ? model_.base : model_.links[body - 1]; }

  // `pose` is the link's in its carrier's frame. Joints of the chain are met in its order, as it
  // has no branches. At most kUrdfLinkLimit deep.
  void add(const urdf::Link& link, const Eigen::Isometry3d& pose, std::size_t carrier,
           const std::size_t* held) {
    lump(link, pose, carrier, held);
    if (link.name == checked_.chain.tip) {
      model_.tip_pose = pose;
    }
    for (const auto& child : link.child_links) {
      const urdf::Joint& joint = *child->parent_joint;
      const auto kept = checked_.held.find(joint.name);
      if (checked_.chain.joints.contains(joint.name)) {
        model_.joints.push_back(to_joint(joint, pose));
        model_.links.emplace_back().name = child->name;
        add(*child, Eigen::Isometry3d::Identity(), model_.links.size(), nullptr);
      } else if (kept != checked_.held.end()) {
        const std::size_t number = held_.size();
        held_.push_back({joint.name, carrier});
        add(*child, pose * to_eigen(joint.parent_to_joint_origin_transform) * kept->second.motion,
            carrier, &number);
      } else {
        add(*child, pose * to_eigen(joint.parent_to_joint_origin_transform), carrier, held);
      }
    }
  }

  // Adds a link's mass and looks to the link that carries it.
  void lump(const urdf::Link& from, const Eigen::Isometry3d& pose, std::size_t carrier,
            const std::size_t* held) {
    std::vector<VisualShape> shapes;
    for (const auto& visual : from.visual_array) {
      shapes.push_back(to_shape(*visual));
    }
    Link& body = get_body(carrier);
    Inertial inertial;
    if (from.inertial) {
      inertial = to_inertial(*from.inertial);
    } else if (density_kg_per_m3_ > 0 && carrier > 0 && !shapes.empty()) {
      inertial = calc_inertial(from.name, shapes);
    }
    if (inertial.mass_kg > 0) {
      body.inertial = combine(body.inertial, transform(inertial, pose));
    }
    if (held != nullptr) {
      held_[*held].mass_kg += inertial.mass_kg;
    }
    for (VisualShape& shape : shapes) {
      shape.pose = pose * shape.pose;
      body.visuals.push_back(std::move(shape));
    }
  }

  // At the density, of a link's shapes in its own frame.
  Inertial calc_inertial(const std::string& link, const std::vector<VisualShape>& shapes) {
    Inertial sum;
    for (const VisualShape& shape : shapes) {
      std::optional<std::filesystem::path> file;
      try {
        sum = combine(sum, calc_shape_inertial(shape, density_kg_per_m3_, folder_, file));
      } catch (const Error& error) {
        throw Error(error.kind(), fmt::format("{}: link '{}': {}", name_, link, error.what()));
      }
      if (file) {
        model_.mass_files.push_back({shape.mesh_file, *file});
      }
    }
    mass_notes_.push_back(fmt::format(
        "link '{}' has no <inertial>: {:.4g} kg and their inertia come from its {} at {} kg/m3",
        link, sum.mass_kg, shapes.size() == 1 ? "shape" : fmt::format("{} shapes", shapes.size()),
        density_kg_per_m3_));
    return sum;
  }

  void check_masses() const {
    for (std::size_t i = 0; i < model_.links.size(); ++i) {
      const Link& link = model_.links[i];
      if (link.inertial.mass_kg > 0) {
        continue;
      }
      const std::string& joint = model_.joints[i].name;
      fail_urdf(name_, checked_.chain.joints.at(joint),
                fmt::format("joint '{}' moves link '{}', which has no mass{}; give it an "
                            "<inertial> element{} (or make the joint fixed)",
                            joint, link.name,
                            density_kg_per_m3_ > 0 ? " and no <visual> to take it from" : "",
                            density_kg_per_m3_ > 0
                                ? ""
                                : ", or set robot.density_kg_per_m3 to take it from the shapes of "
                                  "its <visual> elements"));
    }
  }

  std::string describe(const Held& held) {
    const std::string& place = checked_.held.at(held.joint).place;
    const std::string carrier = held.carrier == 0
                                    ? "the fixed base"
                                    : fmt::format("link '{}'", get_body(held.carrier).name);
    return fmt::format(
        "joint '{}' is not between '{}' and '{}': held at {}, {} part of {}", held.joint,
        checked_.chain.base, checked_.chain.tip, place,
        held.mass_kg > 0 ? fmt::format("its {:.4g} kg are", held.mass_kg) : "what hangs on it is",
        carrier);
  }

  const CheckedUrdf& checked_;
  const std::string& name_;
  double density_kg_per_m3_;
  std::filesystem::path folder_;
  RobotModel model_;
  std::vector<Held> held_;
  std::vector<std::string> mass_notes_;
};

}  // namespace

RobotModel build_model(const CheckedUrdf& checked, const std::string& name,
                       const RobotOptions& options) {
  const urdf::ModelInterfaceSharedPtr from = parse_with_urdfdom(checked.xml, name);
  return Builder(checked, name, options).build(*from);
}

}  // namespace armwright
