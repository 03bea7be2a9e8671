// Reads the mass properties of links, and repairs those that no body can have.

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "base/decompositions.hpp"
#include "base/text.hpp"
#include "sim/robot/urdf_parts.hpp"

namespace armwright {

using tinyxml2::XMLElement;

namespace {

// The largest principal moment may exceed the sum of the others by this fraction, because a thin
// plate's moments can be rounded to three digits.
constexpr double kTriangleTolerance = 1e-3;
// Up to this excess, moments count as those of a plate that were rounded or measured badly.
constexpr double kRepairableExcess = 0.05;

constexpr const char* kEntries[3][3] = {
    {"ixx", "ixy", "ixz"}, {"ixy", "iyy", "iyz"}, {"ixz", "iyz", "izz"}};

Eigen::Matrix3d read_tensor(const XMLElement& inertia, const UrdfXml& xml) {
  xml.check_names(inertia, {}, {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"});
  Eigen::Matrix3d tensor;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      tensor(row, column) = xml.read_number(inertia, kEntries[row][column]);
    }
  }
  return tensor;
}

// Returns the tensor of the same axes whose smaller principal moments are raised by the same amount
// until their sum is the largest. This is the smallest change that makes it a body's.
Eigen::Matrix3d raise_moments(const Eigen::Matrix3d& tensor) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(tensor);
  Eigen::Vector3d moments = solver.eigenvalues();  // ascending
  const double missing = moments[2] - moments[0] - moments[1];
  moments[0] += missing / 2;
  moments[1] += missing / 2;
  const Eigen::Matrix3d raised =
      solver.eigenvectors() * moments.asDiagonal() * solver.eigenvectors().transpose();
  return (raised + raised.transpose()) / 2;  // exactly symmetric, as a file states it
}

Eigen::Vector3d calc_moments(const Eigen::Matrix3d& tensor) {  // ascending
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(tensor, Eigen::EigenvaluesOnly)
      .eigenvalues();
}

// Returns whether a body can have these principal moments.
bool are_possible(const Eigen::Vector3d& moments) {
  return moments[0] > 0 && moments[0] + moments[1] >= (1 - kTriangleTolerance) * moments[2] &&
         moments[2] <= kUrdfLargest;
}

// Returns the tensor of a solid ball of that mass.
Eigen::Matrix3d make_ball_tensor(double mass_kg) {
  const double radius_m =
      std::cbrt(3 * mass_kg / (4 * std::numbers::pi * kRepairDensity_kg_per_m3));
  return 0.4 * mass_kg * radius_m * radius_m * Eigen::Matrix3d::Identity();
}

}  // namespace

std::string write_inertia(const Eigen::Matrix3d& tensor) {
  return fmt::format("<inertia ixx=\"{}\" ixy=\"{}\" ixz=\"{}\" iyy=\"{}\" iyz=\"{}\" izz=\"{}\"/>",
                     format_exact(tensor(0, 0)), format_exact(tensor(0, 1)),
                     format_exact(tensor(0, 2)), format_exact(tensor(1, 1)),
                     format_exact(tensor(1, 2)), format_exact(tensor(2, 2)));
}

std::string write_inertial(const Inertial& body) {
  return fmt::format("<inertial><origin xyz=\"{} {} {}\"/><mass value=\"{}\"/>{}</inertial>",
                     format_exact(body.com_m.x()), format_exact(body.com_m.y()),
                     format_exact(body.com_m.z()), format_exact(body.mass_kg),
                     write_inertia(body.inertia_kg_m2));
}

void InertialChecker::read(const XMLElement& link, const std::string& link_name, UrdfBody& body,
                           UrdfFaults& faults) {
  const auto read_it = [&](UrdfFaults& its_faults) {
    its_faults.attempt([&] {
      if (const XMLElement* inertial = xml_.find_only(link, "inertial")) {
        read_inertial(*inertial, link_name, body, its_faults);
      }
    });
  };
  if (chain_.moving_links.contains(link_name)) {
    read_it(faults);
    return;
  }
  UrdfFaults ignored(link_name);
  read_it(ignored);
  if (const UrdfFault* fault = ignored.first()) {
    std::vector<UrdfEdit> edits;
    for (const XMLElement* e = link.FirstChildElement("inertial"); e != nullptr;
         e = e->NextSiblingElement("inertial")) {
      edits.push_back({numbers_.at(e), UrdfEdit::Kind::remove});
    }
    repairs_.add("the <inertial> of a link that does not move is left out",
                 fmt::format("'{}' (line {}: {})", link_name, fault->line(), fault->detail()),
                 std::move(edits));
  }
}

void InertialChecker::read_inertial(const XMLElement& element, const std::string& link_name,
                                    UrdfBody& body, UrdfFaults& faults) {
  xml_.check_names(element, {"origin", "mass", "inertia"}, {});
  double mass_kg = -1;
  const XMLElement* mass = nullptr;
  const bool has_mass = faults.attempt([&] {
    mass = &xml_.get_only(
        element, "mass",
        "a body needs its mass in kg (leave <inertial> out for a frame without mass)");
    xml_.check_names(*mass, {}, {"value"});
    mass_kg = xml_.read_number(*mass, "value");
    if (mass_kg < 0) {
      xml_.fail(*mass, fmt::format("<mass>: value is {}; it must be > 0", mass_kg));
    }
  });
  const XMLElement& inertia = xml_.get_only(
      element, "inertia", "a body needs its inertia about the centre of mass in kg m2");
  const Eigen::Matrix3d tensor = read_tensor(inertia, xml_);
  if (!has_mass) {
    return;
  }
  if (mass_kg == 0 && tensor.isZero(0)) {
    massless_.push_back(fmt::format("'{}'", link_name));
    body.zero_inertial = numbers_.at(&element);
    return;
  }
  if (mass_kg == 0) {
    if (repair_) {
      repairs_.add("an <inertial> with mass 0 is left out",
                   fmt::format("'{}' (line {})", link_name, element.GetLineNum()),
                   {{numbers_.at(&element), UrdfEdit::Kind::remove}});
      return;
    }
    xml_.fail(*mass,
              "<mass>: value is 0; it must be > 0 (a frame without mass has an inertia of zeros, "
              "or no <inertial>)");
  }
  // The matrix is symmetric because URDF names each off-diagonal entry once.
  const Inertial about_com{mass_kg, Eigen::Vector3d::Zero(),
                           check_tensor(inertia, tensor, mass_kg, link_name)};
  body.inertial = transform(about_com, read_origin(element, xml_));
}

// Returns the tensor, or a repaired one.
Eigen::Matrix3d InertialChecker::check_tensor(const XMLElement& inertia,
                                              const Eigen::Matrix3d& tensor, double mass_kg,
                                              const std::string& link_name) {
  const Eigen::Vector3d moments = calc_moments(tensor);
  const bool is_definite = moments[0] > 0;
  const double sum = moments[0] + moments[1];
  if (is_definite && sum >= (1 - kTriangleTolerance) * moments[2]) {
    return tensor;
  }
  const auto repair_as = [&](const Eigen::Matrix3d& repaired, const std::string& kind,
                             const std::string& detail) {
    repairs_.add(kind, fmt::format("'{}' (line {}, {})", link_name, inertia.GetLineNum(), detail),
                 {{numbers_.at(&inertia), UrdfEdit::Kind::replace, write_inertia(repaired)}});
    return repaired;
  };
  // A tensor of tiny or huge numbers may remain impossible; it is refused.
  const bool may_repair = repair_ && chain_.moving_links.contains(link_name);
  const Eigen::Matrix3d raised = raise_moments(tensor);
  if (may_repair && is_definite && moments[2] < (1 + kRepairableExcess) * sum &&
      are_possible(calc_moments(raised))) {
    return repair_as(raised,
                     "the smaller moments of an <inertia> are raised until their sum is the "
                     "largest, as in a flat body",
                     fmt::format("{:.2g} % were missing", 100 * (moments[2] / sum - 1)));
  }
  const Eigen::Matrix3d ball = make_ball_tensor(mass_kg);
  if (may_repair && chain_.carried_links.contains(link_name) && are_possible(calc_moments(ball))) {
    return repair_as(ball,
                     fmt::format("an <inertia> that no body has is left out, and the link counts "
                                 "as a ball of {} kg/m3",
                                 kRepairDensity_kg_per_m3),
                     fmt::format("{:.4g} kg, moments {:.3g}, {:.3g}, {:.3g} kg m2", mass_kg,
                                 moments[0], moments[1], moments[2]));
  }
  const std::string found =
      fmt::format("<inertia> has the principal moments {:.6g}, {:.6g}, {:.6g} kg m2", moments[0],
                  moments[1], moments[2]);
  if (!is_definite) {
    xml_.fail(inertia,
              found + "; all must be > 0 (a positive definite tensor about the centre of mass)");
  }
  xml_.fail(
      inertia,
      found + "; no body has such moments: the largest must not exceed the sum of the other two");
}

std::vector<std::string> InertialChecker::make_notes() const {
  if (massless_.empty()) {
    return {};
  }
  return {fmt::format("<inertial> with zeros is taken for none: {}", join(massless_, ", "))};
}

}  // namespace armwright
