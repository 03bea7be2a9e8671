#include "sim/identification/plant_parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/decompositions.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

using Kind = PlantParameter::Kind;
using Eigen::Matrix3d;
using Eigen::Matrix4d;

// The ends of the range that an identification gives to a counterbalance's corrections.
constexpr double kLeastScale = 1e-3;
constexpr double kMostSlope = 0.95;

constexpr const char* kPayloadParts[] = {"mass", "x", "y", "z"};

// Appends parameters of one group.
class ParameterList {
 public:
  ParameterList(const RobotModel& robot, const std::vector<bool>& has_link_encoder)
      : robot_(robot), has_link_encoder_(has_link_encoder) {}

  void add(FitGroup group) {
    switch (group) {
      case FitGroup::payload:
        for (int part = 0; part < 4; ++part) {
          add(Kind::payload, 0, part, fmt::format("payload.{}", kPayloadParts[part]),
              part == 0 ? "kg" : "m");
        }
        return;
      case FitGroup::delay:
        add(Kind::delay, 0, 0, "delay", "s");
        return;
      case FitGroup::inertial:
        for (std::size_t i = 0; i < robot_.links.size(); ++i) {
          for (int part = 0; part < kLinkNumbers; ++part) {
            add(Kind::inertia, i, part,
                fmt::format("{}.inertia_{}", robot_.links[i].name, part + 1), "");
          }
        }
        return;
      default:
        for (std::size_t i = 0; i < robot_.joints.size(); ++i) {
          add_of_joint(group, i);
        }
    }
  }
  std::vector<PlantParameter> take() { return std::move(all_); }

 private:
  void add(Kind kind, std::size_t joint, int part, std::string name, std::string unit) {
    all_.push_back({kind, joint, part, std::move(name), std::move(unit)});
  }
  void add_of_joint(FitGroup group, std::size_t i) {
    const Joint& joint = robot_.joints[i];
    const bool turns = joint.kind == JointKind::revolute;
    const std::string effort = get_effort_unit(joint.kind);
    const std::string position = turns ? "rad" : "m";
    const auto add_one = [&](Kind kind, const char* name, const std::string& unit, int part = 0) {
      add(kind, i, part, fmt::format("{}.{}", joint.name, name), unit);
    };
    switch (group) {
      case FitGroup::friction:
        add_one(Kind::viscous, "viscous", turns ? "N m s/rad" : "N s/m");
        add_one(Kind::coulomb, "coulomb", effort);
        add_one(Kind::offset, "offset", effort);
        return;
      case FitGroup::stribeck:
        add_one(Kind::breakaway, "breakaway", effort);
        add_one(Kind::stribeck_rate, "stribeck_rate", position + "/s");
        return;
      case FitGroup::armature:
        add_one(Kind::armature, "armature", turns ? "kg m^2" : "kg");
        return;
      case FitGroup::counterbalance:
        if (!joint.plant.counterbalance.efforts.empty()) {
          add_one(Kind::counterbalance, "counterbalance", "", 0);
        }
        return;
      case FitGroup::counterbalance_slope:
        if (!joint.plant.counterbalance.efforts.empty()) {
          add_one(Kind::counterbalance, "counterbalance_slope", "", 1);
        }
        return;
      case FitGroup::stiffness:
        if (i < has_link_encoder_.size() && has_link_encoder_[i]) {
          add_one(Kind::stiffness, "stiffness", effort + "/" + position);
          add_one(Kind::encoder_offset, "encoder_offset", position);
        }
        return;
      default:
        return;
    }
  }

  const RobotModel& robot_;
  const std::vector<bool>& has_link_encoder_;
  std::vector<PlantParameter> all_;
};

Matrix4d make_factor(std::span<const double, kLinkNumbers> p) {
  Matrix4d u;
  u << std::exp(p[1]), p[4], p[5], p[7],  //
      0, std::exp(p[2]), p[6], p[8],      //
      0, 0, std::exp(p[3]), p[9],         //
      0, 0, 0, 1;
  return std::exp(p[0]) * u;
}

// Returns the numbers of a link with the pseudo-inertia [S, h; h^T, m].
LinkNumbers read_pseudo_inertia(const Matrix4d& pseudo) {
  const Matrix3d second = pseudo.topLeftCorner<3, 3>();
  const Matrix3d inertia = second.trace() * Matrix3d::Identity() - second;
  LinkNumbers numbers;
  numbers << pseudo(3, 3), pseudo.block<3, 1>(0, 3), inertia(0, 0), inertia(0, 1), inertia(0, 2),
      inertia(1, 1), inertia(1, 2), inertia(2, 2);
  return numbers;
}

// Moves the value of a joint's parameter into the joint.
void set_joint_parameter(Joint& joint, const PlantParameter& parameter, double value) {
  JointPlant& plant = joint.plant;
  switch (parameter.kind) {
    case Kind::viscous:
      plant.viscous = std::max(0.0, value);
      break;
    case Kind::coulomb:  // keeps s_t
      plant.coulomb = std::max(0.0, value);
      break;
    case Kind::offset:
      plant.offset = value;
      break;
    case Kind::breakaway:
      plant.stribeck = std::max(0.0, value) - plant.coulomb;
      break;
    case Kind::stribeck_rate:
      plant.stribeck_rate = std::max(plant.transition_rate, value);
      break;
    case Kind::armature:
      plant.armature = std::max(0.0, value);
      break;
    case Kind::stiffness:
      plant.stiffness = std::max(0.0, value);
      break;
    case Kind::counterbalance: {
      Counterbalance& balance = plant.counterbalance;
      if (parameter.part == 0) {
        balance.correct(std::max(kLeastScale, value), balance.slope);
      } else {
        balance.correct(balance.scale, std::clamp(value, -kMostSlope, kMostSlope));
      }
      break;
    }
    default:
      break;
  }
}

}  // namespace

const std::vector<std::string>& fit_group_names() {
  static const std::vector<std::string> names = {
      "friction",  "stribeck", "armature", "payload", "counterbalance", "counterbalance_slope",
      "stiffness", "delay",    "inertial"};
  return names;
}

std::vector<PlantParameter> list_parameters(const RobotModel& robot,
                                            std::span<const FitGroup> groups,
                                            const std::vector<bool>& has_link_encoder) {
  ParameterList list(robot, has_link_encoder);
  for (std::size_t i = 0; i < fit_group_names().size(); ++i) {
    const auto group = static_cast<FitGroup>(i);
    if (std::ranges::find(groups, group) != groups.end()) {
      list.add(group);
    }
  }
  return list.take();
}

std::vector<PlantParameter> find_parameters(const RobotModel& robot,
                                            std::span<const std::string> names) {
  std::vector<FitGroup> groups;
  for (std::size_t i = 0; i < fit_group_names().size(); ++i) {
    groups.push_back(static_cast<FitGroup>(i));
  }
  const std::vector<PlantParameter> all =
      list_parameters(robot, groups, std::vector<bool>(robot.joint_count(), true));
  std::vector<PlantParameter> found;
  for (const std::string& name : names) {
    const auto it = std::ranges::find(all, name, &PlantParameter::name);
    if (it == all.end()) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("'{}' is no parameter of robot '{}'; its parameters are named like "
                              "'{}'",
                              sanitize(name), sanitize(robot.name), sanitize(all.front().name)));
    }
    found.push_back(*it);
  }
  return found;
}

double get_parameter(const RobotModel& robot, const PlantParameter& parameter) {
  const JointPlant& plant = robot.joints[parameter.joint].plant;
  switch (parameter.kind) {
    case Kind::viscous:
      return plant.viscous;
    case Kind::coulomb:
      return plant.coulomb;
    case Kind::offset:
      return plant.offset;
    case Kind::breakaway:
      return plant.coulomb + plant.stribeck;
    case Kind::stribeck_rate:
      return plant.stribeck_rate;
    case Kind::armature:
      return plant.armature;
    case Kind::payload: {
      const Inertial payload = robot.payload.value_or(Inertial{});
      return parameter.part == 0 ? payload.mass_kg : payload.com_m[parameter.part - 1];
    }
    case Kind::counterbalance:
      return parameter.part == 0 ? plant.counterbalance.scale : plant.counterbalance.slope;
    case Kind::stiffness:
      return plant.stiffness;
    case Kind::encoder_offset:
    case Kind::delay:
      return 0;
    case Kind::inertia:
      return calc_inertia_parameters(robot.links[parameter.joint].inertial)[parameter.part];
  }
  return 0;
}

std::vector<double> get_parameters(const RobotModel& robot,
                                   std::span<const PlantParameter> parameters) {
  std::vector<double> values;
  for (const PlantParameter& parameter : parameters) {
    values.push_back(get_parameter(robot, parameter));
  }
  return values;
}

void set_payload(RobotModel& robot, const Inertial& payload) {
  const auto in_link = [&](const Inertial& body) {
    return to_link_numbers(transform(body, robot.tip_pose));
  };
  Inertial& last = robot.links.back().inertial;
  LinkNumbers numbers = to_link_numbers(last) + in_link(payload);
  if (robot.payload) {
    numbers -= in_link(*robot.payload);
  }
  last = to_inertial(numbers);
  robot.payload = payload;
}

void set_parameters(RobotModel& robot, std::span<const PlantParameter> parameters,
                    std::span<const double> values) {
  std::optional<Inertial> payload;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const PlantParameter& parameter = parameters[i];
    if (parameter.kind == Kind::payload) {
      if (!payload) {
        payload = robot.payload.value_or(Inertial{});
      }
      (parameter.part == 0 ? payload->mass_kg : payload->com_m[parameter.part - 1]) = values[i];
    } else if (parameter.kind == Kind::inertia) {
      if (parameter.part == 0) {
        robot.links[parameter.joint].inertial =
            to_inertial(calc_link_numbers(values.subspan(i).first<kLinkNumbers>()));
      }
    } else if (parameter.kind != Kind::delay && parameter.kind != Kind::encoder_offset) {
      set_joint_parameter(robot.joints[parameter.joint], parameter, values[i]);
    }
  }
  for (Joint& joint : robot.joints) {
    joint.plant.stribeck = std::max(joint.plant.stribeck, -joint.plant.coulomb);
  }
  if (payload) {
    payload->mass_kg = std::max(0.0, payload->mass_kg);
    set_payload(robot, *payload);
  }
}

LinkNumbers calc_link_numbers(std::span<const double, kLinkNumbers> parameters,
                              Eigen::Matrix<double, 10, 10>* derivatives) {
  const Matrix4d u = make_factor(parameters);
  if (derivatives != nullptr) {
    constexpr int kPlaces[][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2},
                                  {1, 2}, {0, 3}, {1, 3}, {2, 3}};
    derivatives->col(0) = read_pseudo_inertia(2 * u * u.transpose());
    for (int i = 0; i < 9; ++i) {
      const auto [row, column] = kPlaces[i];
      Matrix4d change = Matrix4d::Zero();
      change(row, column) = i < 3 ? u(row, column) : u(3, 3);
      const Matrix4d half = change * u.transpose();
      derivatives->col(i + 1) = read_pseudo_inertia(half + half.transpose());
    }
  }
  return read_pseudo_inertia(u * u.transpose());
}

LinkNumbers calc_inertia_parameters(const Inertial& body) {
  const LinkNumbers n = to_link_numbers(body);
  Matrix3d inertia;
  inertia << n[4], n[5], n[6], n[5], n[7], n[8], n[6], n[8], n[9];
  Matrix4d pseudo;
  pseudo << 0.5 * inertia.trace() * Matrix3d::Identity() - inertia, n.segment<3>(1),
      n.segment<3>(1).transpose(), n[0];
  // An upper factor is the lower one of the reversed matrix, reversed.
  const Matrix4d reversed = pseudo.reverse();
  const Matrix4d lower = reversed.llt().matrixL();
  const Matrix4d u = lower.reverse();
  const double scale = u(3, 3);
  LinkNumbers p;
  p << std::log(scale), std::log(u(0, 0) / scale), std::log(u(1, 1) / scale),
      std::log(u(2, 2) / scale), u(0, 1) / scale, u(0, 2) / scale, u(1, 2) / scale, u(0, 3) / scale,
      u(1, 3) / scale, u(2, 3) / scale;
  return p;
}

}  // namespace armwright
