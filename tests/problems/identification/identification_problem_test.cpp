// Finding a robot's parameters in recorded motions: derivatives, the linear start, known truth, and
// the recordings of a KUKA KR300 (docs/identification.md).
#include "problems/identification/identification_problem.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "base/expect_error.hpp"
#include "base/random.hpp"
#include "problems/config/problem_loader.hpp"
#include "problems/identification/effort_check.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kNormalGravity_m_per_s2 = 9.80665;

// A motion of sines, two per joint, over 10 s; exact derivatives and the efforts of `truth`.
LogSamples record_sines(const RobotModel& truth, double noise, std::uint64_t seed) {
  const auto n = static_cast<Eigen::Index>(truth.joint_count());
  constexpr int kSamples = 500;
  LogSamples log;
  log.period_s = 0.02;
  for (Eigen::MatrixXd* rows : {&log.positions, &log.rates, &log.accelerations}) {
    rows->resize(kSamples, n);
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = 0; k < kSamples; ++k) {
      const double t = static_cast<double>(k) * log.period_s;
      double q = 0, v = 0, a = 0;
      for (const auto& [amplitude, hertz] :
           {std::pair{0.5, 0.23 + 0.05 * static_cast<double>(i)}, {0.12, 0.9}}) {
        const double w = 2 * std::numbers::pi * hertz;
        const double phase = w * t + static_cast<double>(i);
        q += amplitude * std::sin(phase);
        v += amplitude * w * std::cos(phase);
        a -= amplitude * w * w * std::sin(phase);
      }
      log.positions(k, i) = q;
      log.rates(k, i) = v;
      log.accelerations(k, i) = a;
    }
  }
  log.link_positions = log.positions;
  log.link_rates = log.rates;
  log.link_accelerations = log.accelerations;
  JointMotion motion = {log.positions, log.rates, log.accelerations};
  const Eigen::MatrixXd links = PlantModel(truth, {}, kNormalGravity_m_per_s2, motion)
                                    .calc({}, false)
                                    .link.reshaped<Eigen::RowMajor>(kSamples, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double stiffness = truth.joints[static_cast<std::size_t>(i)].plant.stiffness;
    const Eigen::VectorXd twist =
        stiffness > 0 ? Eigen::VectorXd(links.col(i) / stiffness) : Eigen::VectorXd::Zero(kSamples);
    log.positions.col(i) += twist + Eigen::VectorXd::Constant(kSamples, stiffness > 0 ? 0.001 : 0);
    for (Eigen::Index k = 1; k + 1 < kSamples; ++k) {
      log.rates(k, i) += (twist[k + 1] - twist[k - 1]) / (2 * log.period_s);
      log.accelerations(k, i) +=
          (twist[k + 1] - 2 * twist[k] + twist[k - 1]) / (log.period_s * log.period_s);
    }
  }
  motion.motor_rates = log.rates;
  motion.motor_accelerations = log.accelerations;
  log.efforts = PlantModel(truth, {}, kNormalGravity_m_per_s2, motion)
                    .calc({}, false)
                    .motor.reshaped<Eigen::RowMajor>(kSamples, n);
  log.effort_factors.setOnes(n);
  RandomStream random("test/log noise", seed);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double most = log.efforts.col(i).cwiseAbs().maxCoeff();
    for (Eigen::Index k = 0; k < kSamples; ++k) {
      log.efforts(k, i) += noise * most * random.normal();
    }
  }
  return log;
}

RobotModel make_true_arm() {
  RobotModel arm = load_urdf(ARMWRIGHT_CONFIGS "/robots/arm7.urdf");
  for (std::size_t i = 0; i < arm.joint_count(); ++i) {
    JointPlant& plant = arm.joints[i].plant;
    const double size = 1 / (1 + static_cast<double>(i));
    plant.armature = 0.8 * size;
    plant.viscous = 4 * size;
    plant.coulomb = 3 * size;
    plant.offset = 0.5 * size;
    plant.stiffness = 2e4 * size;
  }
  set_payload(arm, {3, {0.02, -0.01, 0.05}, Eigen::Matrix3d::Zero()});
  return arm;
}

IdentificationConfig make_config(std::vector<FitGroup> groups, double noise = 0,
                                 std::uint64_t seed = 0) {
  IdentificationConfig config;
  config.name = "test";
  config.robot = config.plain = load_urdf(ARMWRIGHT_CONFIGS "/robots/arm7.urdf");
  config.gravity_m_per_s2 = kNormalGravity_m_per_s2;
  config.groups = std::move(groups);
  config.fitted = {{"log", record_sines(make_true_arm(), noise, seed)}};
  return config;
}

double get_truth(const RobotModel& truth, const PlantParameter& parameter) {
  if (parameter.kind == PlantParameter::Kind::encoder_offset) {
    return 0.001;
  }
  return get_parameter(truth, parameter);
}

TEST(IdentificationProblem, HasTheDerivativesOfItsResiduals) {
  IdentificationConfig config =
      make_config({FitGroup::friction, FitGroup::stribeck, FitGroup::armature, FitGroup::payload,
                   FitGroup::stiffness, FitGroup::delay},
                  0.01);
  const IdentificationProblem problem(config);
  std::vector<double> x = list_starts(problem.description().variables);
  x.back() = 0.004;  // the delay
  const auto& motion = problem.fitted().front();
  const auto here = problem.calc_residuals(motion, x, true);
  ASSERT_EQ(problem.parameters().back().name, "delay");
  for (std::size_t p = 0; p < x.size(); ++p) {
    const DecisionVariable& variable = problem.description().variables[p];
    const double step = variable.scale == Scale::logarithmic
                            ? 1e-5 * x[p]
                            : 1e-7 * (variable.upper - variable.lower);
    std::vector<double> up = x, down = x;
    up[p] += step;
    down[p] -= step;
    const Eigen::VectorXd slope = (problem.calc_residuals(motion, up, false).values -
                                   problem.calc_residuals(motion, down, false).values) /
                                  (2 * step);
    EXPECT_LT((here.jacobian.col(static_cast<Eigen::Index>(p)) - slope).norm(),
              1e-5 * slope.norm() + 1e-9)
        << variable.name;
  }
}

TEST(IdentificationProblem, StartsAtTheTruthIfTheLogIsExact) {
  const IdentificationProblem problem(make_config(
      {FitGroup::friction, FitGroup::armature, FitGroup::payload, FitGroup::stiffness}));
  const RobotModel truth = make_true_arm();
  for (std::size_t p = 0; p < problem.parameters().size(); ++p) {
    const double expected = get_truth(truth, problem.parameters()[p]);
    EXPECT_NEAR(problem.description().variables[p].start, expected, 1e-6 * (1 + std::abs(expected)))
        << problem.parameters()[p].name;
  }
}

TEST(IdentificationProblem, ItsObjectiveIsTheSumOfItsSquaredResiduals) {
  const IdentificationProblem problem(make_config({FitGroup::friction}, 0.02));
  const std::vector<double> x = list_starts(problem.description().variables);
  const Evaluation evaluation = problem.evaluate(x, {CaseRole::training, "train/1", {0}}, true);
  double sum = 0;
  for (const double residual : evaluation.residuals) {
    sum += residual * residual;
  }
  EXPECT_NEAR(evaluation.objectives.front(), sum, 1e-14);
  EXPECT_EQ(evaluation.jacobian.size(), evaluation.residuals.size() * x.size());
}

TEST(IdentificationProblem, HeldBackLogsAreTheTestAndNotTheTraining) {
  IdentificationConfig config =
      make_config({FitGroup::friction, FitGroup::armature, FitGroup::payload}, 0.02);
  config.held_back = {{"other", record_sines(config.robot, 0, 1)}};  // an arm without friction
  const IdentificationProblem problem(config);
  const std::vector<double> x = list_starts(problem.description().variables);
  const double trained = problem.evaluate(x, {CaseRole::training, "train/1", {0}}).case_errors[0];
  const double judged = problem.evaluate(x, {CaseRole::test, "test/2", {0}}).case_errors[0];
  EXPECT_GT(judged, 2 * trained);
}

TEST(EffortFaults, NameAWrongSignAndSwappedEfforts) {
  IdentificationConfig config = make_config({FitGroup::friction}, 0.01);
  config.robot = make_true_arm();
  EXPECT_THAT(find_effort_faults(IdentificationProblem(config)), IsEmpty());
  IdentificationConfig wrong = config;
  wrong.fitted[0].samples.efforts.col(3) *= -1;
  EXPECT_THAT(find_effort_faults(IdentificationProblem(wrong)),
              ElementsAre(testing::AllOf(HasSubstr("log: the efforts of joint 'joint_4' have the "
                                                   "opposite sign"),
                                         HasSubstr("give --sign joint_4=-1"))));
  wrong = config;
  wrong.fitted[0].samples.efforts.col(1).swap(wrong.fitted[0].samples.efforts.col(3));
  EXPECT_THAT(find_effort_faults(IdentificationProblem(wrong)),
              ElementsAre(HasSubstr("the efforts of joints 'joint_2' and 'joint_4' are swapped")));
  // Torques of motors, exchanged before their gears made efforts of them.
  LogSamples& samples = wrong.fitted[0].samples;
  samples.effort_factors[1] = 50;
  samples.effort_factors[3] = 200;
  samples.efforts.col(1) *= 50.0 / 200;
  samples.efforts.col(3) *= 200.0 / 50;
  EXPECT_THAT(find_effort_faults(IdentificationProblem(wrong)),
              ElementsAre(HasSubstr("the efforts of joints 'joint_2' and 'joint_4' are swapped")));
  wrong = config;
  for (Eigen::MatrixXd* rows :
       {&samples.positions, &samples.rates, &samples.accelerations, &samples.link_positions,
        &samples.link_rates, &samples.link_accelerations, &samples.efforts}) {
    rows->col(1).swap(rows->col(3));
  }
  EXPECT_THAT(find_effort_faults(IdentificationProblem(wrong)),
              ElementsAre(HasSubstr("joints 'joint_2' and 'joint_4' are swapped: with their "
                                    "positions and efforts exchanged")));
}

// The recordings of the KR300, at the motor's side as the facts have them.
LoadedProblem load_kr300(const std::string& fitted, const std::string& held_back) {
  const std::string folder = ARMWRIGHT_CONFIGS "/logs/kr300/trajectory-";
  return load_problem(
      "identify",
      std::vector<std::string>{"identification.logs=[\"" + folder + fitted + ".csv\"]",
                               "identification.validate=[\"" + folder + held_back + ".csv\"]"});
}

// What an independent computation finds with the data sheet and 200 kg (Python, recursive
// Newton-Euler from the table of Denavit and Hartenberg): root mean squares at the motor, N m.
TEST(Kr300Recordings, TheDataSheetHasTheErrorsOfAnIndependentComputation) {
  const LoadedProblem loaded = load_kr300("A", "B");
  const IdentificationProblem& problem = *find_identification(*loaded.problem);
  const double expected[2][6] = {{2.388, 2.735, 4.010, 0.389, 0.673, 1.051},
                                 {1.936, 2.492, 3.578, 0.323, 0.583, 0.658}};
  const FittedMotion* motions[] = {&problem.fitted().front(), &problem.judged().front()};
  for (int set = 0; set < 2; ++set) {
    const Eigen::VectorXd rms =
        problem.calc_residuals(*motions[set], problem.own_values(), false).rms;
    for (Eigen::Index i = 0; i < 6; ++i) {
      const double ratio = problem.robot().joints[static_cast<std::size_t>(i)].plant.gear_ratio;
      EXPECT_NEAR(rms[i] / ratio, expected[set][i], 0.02 * expected[set][i])
          << "trajectory " << set << ", axis " << i + 1;
    }
  }
}

TEST(IdentificationReader, RefusesWhatCannotBeFitted) {
  const auto load = [](const std::string& setting) {
    return [setting] { load_problem("identify", std::vector<std::string>{setting}); };
  };
  EXPECT_THAT(error_of(ErrorKind::usage, load("identification.fit=[\"masses\"]")),
              HasSubstr("'masses' cannot be fitted; each must be one of friction, stribeck"));
  EXPECT_THAT(error_of(ErrorKind::usage, load("identification.fit=[\"inertial\", \"payload\"]")),
              HasSubstr("inertial includes the payload"));
  EXPECT_THAT(error_of(ErrorKind::usage, load("identification.fit=[\"stribeck\"]")),
              HasSubstr("stribeck needs friction"));
  EXPECT_THAT(error_of(ErrorKind::usage, load("identification.logs=[]")),
              HasSubstr("it must name at least one log"));
  EXPECT_THAT(error_of(ErrorKind::io, load("identification.logs=[\"nothing.csv\"]")),
              HasSubstr("nothing.csv"));
}

}  // namespace
}  // namespace armwright
