#include "sim/identification/plant_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/decompositions.hpp"
#include "base/random.hpp"
#include "sim/dynamics/arm_equations.hpp"
#include "sim/generated_arm.hpp"
#include "sim/identification/fitted_plant.hpp"

namespace armwright {
namespace {

constexpr double kGravity_m_per_s2 = 9.80665;

std::vector<RobotModel> make_identified_arms() {
  std::vector<RobotModel> arms;
  for (const char* name : {"arm7", "irb4600_six", "kr300", "planar2"}) {
    arms.push_back(load_urdf(std::string(ARMWRIGHT_CONFIGS "/robots/") + name + ".urdf"));
  }
  for (int i = 0; i < kGeneratedArms; ++i) {
    arms.push_back(parse_urdf(make_arm_urdf(i), "generated"));
  }
  RobotModel sliding = arms.front();
  sliding.joints[0].kind = JointKind::prismatic;
  sliding.joints[3].kind = JointKind::prismatic;
  arms.push_back(sliding);
  return arms;
}

std::vector<double> draw(RandomStream& random, std::size_t n, double most) {
  std::vector<double> numbers;
  for (std::size_t i = 0; i < n; ++i) {
    numbers.push_back(random.uniform(-most, most));
  }
  return numbers;
}

TEST(LinkRegressor, GivesTheEffortsOfTheEquationsOfMotion) {
  for (const RobotModel& arm : make_identified_arms()) {
    SCOPED_TRACE(arm.name);
    const std::size_t n = arm.joint_count();
    const articulated::ChainModel chain(arm, kGravity_m_per_s2);
    articulated::ArmEquations equations(chain);
    const LinkRegressor regressor(arm, kGravity_m_per_s2);
    Eigen::VectorXd numbers(static_cast<Eigen::Index>(n) * kLinkNumbers);
    for (std::size_t i = 0; i < n; ++i) {
      numbers.segment<kLinkNumbers>(static_cast<Eigen::Index>(i) * kLinkNumbers) =
          to_link_numbers(arm.links[i].inertial);
    }
    Eigen::MatrixXd y(static_cast<Eigen::Index>(n), numbers.size());
    RandomStream random("test/regressor", n);
    for (int sample = 0; sample < 10; ++sample) {
      const auto q = draw(random, n, 2), v = draw(random, n, 3), a = draw(random, n, 5);
      regressor.calc(q, v, a, y);
      const Eigen::VectorXd efforts = y * numbers;
      equations.set(q, v);
      for (std::size_t i = 0; i < n; ++i) {
        double expected = equations.bias(i);
        for (std::size_t k = 0; k < n; ++k) {
          expected += equations.mass(i, k) * a[k];
        }
        EXPECT_NEAR(efforts[static_cast<Eigen::Index>(i)], expected,
                    1e-10 * (1 + std::abs(expected)))
            << "joint " << i;
      }
    }
  }
}

TEST(LinkNumbers, AreTheBodyAgain) {
  const RobotModel arm = load_urdf(ARMWRIGHT_CONFIGS "/robots/arm7.urdf");
  for (const Link& link : arm.links) {
    const Inertial again = to_inertial(to_link_numbers(link.inertial));
    EXPECT_DOUBLE_EQ(again.mass_kg, link.inertial.mass_kg);
    EXPECT_LT((again.com_m - link.inertial.com_m).norm(), 1e-14);
    EXPECT_LT((again.inertia_kg_m2 - link.inertial.inertia_kg_m2).norm(), 1e-13);
  }
}

TEST(InertiaParameters, GiveTheBodyBack) {
  const RobotModel arm = load_urdf(ARMWRIGHT_CONFIGS "/robots/arm7.urdf");
  for (const Link& link : arm.links) {
    const LinkNumbers p = calc_inertia_parameters(link.inertial);
    const LinkNumbers again =
        calc_link_numbers(std::span<const double, kLinkNumbers>(p.data(), kLinkNumbers));
    EXPECT_LT((again - to_link_numbers(link.inertial)).norm(), 1e-12);
  }
}

TEST(InertiaParameters, AlwaysGiveABodyThatCanExist) {
  RandomStream random("test/inertia", 1);
  for (int i = 0; i < 200; ++i) {
    const std::vector<double> p = draw(random, kLinkNumbers, 2);
    const Inertial body = to_inertial(calc_link_numbers(std::span<const double, kLinkNumbers>(p)));
    EXPECT_GT(body.mass_kg, 0);
    const Eigen::Vector3d moments =
        body.inertia_kg_m2.selfadjointView<Eigen::Lower>().eigenvalues();
    EXPECT_GT(moments[0], 0);
    EXPECT_LT(moments[2], (moments[0] + moments[1]) * (1 + 1e-9));
  }
}

TEST(Payload, IsTheSameAsALoadOfTheTask) {
  const RobotModel arm = load_urdf(ARMWRIGHT_CONFIGS "/robots/irb4600_six.urdf");
  const Eigen::Vector3d com_m(0.1, -0.2, 0.3);
  const Eigen::Matrix3d inertia = Eigen::Vector3d(0.02, 0.03, 0.04).asDiagonal();
  const RobotModel loaded = add_load(arm, 20, LoadBody{com_m, inertia / 20});
  RobotModel with = arm;
  set_payload(with, {5, -com_m, inertia});
  set_payload(with, {20, com_m, inertia});  // replaces the first one
  const LinkNumbers difference =
      to_link_numbers(with.links.back().inertial) - to_link_numbers(loaded.links.back().inertial);
  EXPECT_LT(difference.norm(), 1e-11);
  set_payload(with, {});
  EXPECT_LT(
      (to_link_numbers(with.links.back().inertial) - to_link_numbers(arm.links.back().inertial))
          .norm(),
      1e-11);
}

// Verification scales all masses, and each case then has a payload of its own.
TEST(Payload, IsScaledWithTheLinkThatItIsAPartOf) {
  const RobotModel arm = load_urdf(ARMWRIGHT_CONFIGS "/robots/irb4600_six.urdf");
  RobotModel with = arm;
  set_payload(with, {200, {0.1, -0.2, 0.3}, Eigen::Matrix3d::Identity()});
  RobotModel bare = scale_masses(with, 0.9);
  set_payload(bare, {});
  const LinkNumbers expected = to_link_numbers(scale_masses(arm, 0.9).links.back().inertial);
  EXPECT_LT((to_link_numbers(bare.links.back().inertial) - expected).norm(), 1e-11);
}

// An arm with everything that can be fitted.
RobotModel make_rich_arm() {
  RobotModel arm = load_urdf(ARMWRIGHT_CONFIGS "/robots/irb4600_six.urdf");
  for (std::size_t i = 0; i < arm.joint_count(); ++i) {
    JointPlant& plant = arm.joints[i].plant;
    const double size = 1 + static_cast<double>(i);
    plant.armature = 3 * size;
    plant.viscous = 20 / size;
    plant.coulomb = 15 / size;
    plant.stribeck = 4 / size;
    plant.transition_rate = 0.05;
    plant.stribeck_rate = 0.4;
    plant.offset = 2;
    plant.stiffness = 1e5;
  }
  Counterbalance& balance = arm.joints[1].plant.counterbalance;
  balance.lower = arm.joints[1].lower;
  balance.upper = arm.joints[1].upper;
  for (int i = 0; i < 65; ++i) {
    balance.efforts.push_back(800 * std::sin(0.05 * i));
  }
  balance.correct(0.9, 0.1);
  set_payload(arm, {12, {0.05, 0.02, 0.1}, Eigen::Vector3d(0.1, 0.1, 0.1).asDiagonal()});
  return arm;
}

JointMotion draw_motion(const RobotModel& arm, int samples) {
  RandomStream random("test/motion", 3);
  const auto n = static_cast<Eigen::Index>(arm.joint_count());
  JointMotion motion{Eigen::MatrixXd(samples, n), Eigen::MatrixXd(samples, n),
                     Eigen::MatrixXd(samples, n)};
  for (Eigen::Index k = 0; k < samples; ++k) {
    for (Eigen::Index i = 0; i < n; ++i) {
      motion.positions(k, i) = random.uniform(-0.8, 0.8);
      motion.rates(k, i) = random.uniform(-1, 1);
      motion.accelerations(k, i) = random.uniform(-3, 3);
    }
  }
  return motion;
}

class FitGroups : public testing::TestWithParam<std::size_t> {};

TEST_P(FitGroups, HaveTheDerivativesOfTheEfforts) {
  const RobotModel arm = make_rich_arm();
  const std::vector<FitGroup> groups = {static_cast<FitGroup>(GetParam()), FitGroup::friction,
                                        FitGroup::payload};
  const auto parameters = list_parameters(arm, groups, std::vector<bool>(arm.joint_count(), true));
  const PlantModel model(arm, parameters, kGravity_m_per_s2, draw_motion(arm, 6));
  const std::vector<double> x = get_parameters(arm, parameters);
  const PlantModel::Efforts here = model.calc(x, true);
  for (std::size_t p = 0; p < x.size(); ++p) {
    const double step = 1e-5 * std::max(1.0, std::abs(x[p]));
    std::vector<double> up = x, down = x;
    up[p] += step;
    down[p] -= step;
    const PlantModel::Efforts above = model.calc(up, false), below = model.calc(down, false);
    const auto column = static_cast<Eigen::Index>(p);
    const Eigen::VectorXd motor = (above.motor - below.motor) / (2 * step);
    const Eigen::VectorXd link = (above.link - below.link) / (2 * step);
    EXPECT_LT((here.motor_jacobian.col(column) - motor).norm(), 1e-6 * (1 + motor.norm()))
        << parameters[p].name;
    EXPECT_LT((here.link_jacobian.col(column) - link).norm(), 1e-6 * (1 + link.norm()))
        << parameters[p].name;
  }
}

// All but inertial, which excludes the payload.
INSTANTIATE_TEST_SUITE_P(All, FitGroups, testing::Range(std::size_t{0}, std::size_t{8}),
                         [](const auto& group) { return fit_group_names()[group.param]; });

TEST(FitGroups, InertialHasTheDerivativesOfTheEfforts) {
  const RobotModel arm = make_rich_arm();
  const FitGroup groups[] = {FitGroup::inertial};
  const auto parameters = list_parameters(arm, groups);
  const PlantModel model(arm, parameters, kGravity_m_per_s2, draw_motion(arm, 6));
  const std::vector<double> x = get_parameters(arm, parameters);
  const PlantModel::Efforts here = model.calc(x, true);
  for (std::size_t p = 0; p < x.size(); ++p) {
    std::vector<double> up = x, down = x;
    up[p] += 1e-5;
    down[p] -= 1e-5;
    const Eigen::VectorXd slope =
        (model.calc(up, false).motor - model.calc(down, false).motor) / 2e-5;
    EXPECT_LT((here.motor_jacobian.col(static_cast<Eigen::Index>(p)) - slope).norm(),
              1e-6 * (1 + slope.norm()))
        << parameters[p].name;
  }
}

TEST(PlantParameters, OwnValuesLeaveTheRobotAsItIs) {
  const RobotModel arm = make_rich_arm();
  std::vector<FitGroup> groups;
  for (std::size_t i = 0; i + 1 < fit_group_names().size(); ++i) {
    groups.push_back(static_cast<FitGroup>(i));
  }
  const auto parameters = list_parameters(arm, groups, std::vector<bool>(arm.joint_count(), true));
  const std::vector<double> x = get_parameters(arm, parameters);
  RobotModel again = arm;
  set_parameters(again, parameters, x);
  for (std::size_t i = 0; i < arm.joint_count(); ++i) {
    const JointPlant &was = arm.joints[i].plant, &is = again.joints[i].plant;
    EXPECT_DOUBLE_EQ(is.stribeck, was.stribeck);
    EXPECT_EQ(is.coulomb, was.coulomb);
    EXPECT_EQ(is.armature, was.armature);
    for (std::size_t k = 0; k < was.counterbalance.efforts.size(); ++k) {
      EXPECT_NEAR(is.counterbalance.efforts[k], was.counterbalance.efforts[k], 1e-9);
    }
  }
}

TEST(FittedPlants, AreDrawnWithTheirCovarianceAndHaveCornersAtTwoDeviations) {
  const RobotModel arm = make_rich_arm();
  FittedPlant fitted;
  fitted.parameters = find_parameters(
      arm,
      std::vector<std::string>{arm.joints[0].name + ".viscous", arm.joints[1].name + ".coulomb"});
  fitted.values = {10, 5};
  fitted.covariance.resize(2, 2);
  fitted.covariance << 4, 1.2, 1.2, 1;
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  constexpr int kDraws = 20000;
  for (int i = 0; i < kDraws; ++i) {
    RandomStream random("test/draw", static_cast<std::uint64_t>(i));
    const std::vector<double> drawn = fitted.draw(random);
    const Eigen::Vector2d way(drawn[0] - 10, drawn[1] - 5);
    sum += way * way.transpose() / kDraws;
  }
  EXPECT_LT((sum - fitted.covariance).norm(), 0.15);
  // Each corner is 2 away in the metric of the covariance, and opposite corners cancel.
  for (std::uint64_t k = 0; k < 4; ++k) {
    const std::vector<double> corner = fitted.get_corner(k);
    const Eigen::Vector2d way(corner[0] - 10, corner[1] - 5);
    EXPECT_NEAR(way.dot(fitted.covariance.inverse() * way), 4, 1e-9);
    EXPECT_EQ(fitted.get_corner(k + 4), corner);
  }
  EXPECT_NEAR(fitted.get_corner(0)[0] + fitted.get_corner(1)[0], 20, 1e-12);
}

}  // namespace
}  // namespace armwright
