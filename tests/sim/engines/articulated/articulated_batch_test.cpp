// A result of the engine `articulated` depends on its own job only. It does not depend on the other
// jobs: their order, number and arms, what they record, and how they end.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "base/random.hpp"
#include "sim/articulated_runs.hpp"

namespace armwright {
namespace {

using namespace articulated_test;

// Two hundred jobs of every kind: designs that work, that explode or that are too weak; with and
// without cut-off, bound and recording; timelines of different lengths; and an unreachable target.
class TwoHundredJobs : public testing::Test {
 protected:
  TwoHundredJobs() {
    const ArmDesign* const designs[] = {&kTableA1, &kTableA5, &kTableA10, &kLimp, &kExploding};
    for (std::uint64_t number = 0; number < 40; ++number) {
      const int points = number % 4 == 3 ? 4 : 3;
      TestCase test_case = make_case(number, points);
      if (number == 17) {
        test_case.points_m[1] = {2.9, 0.4, 1.1};
      }
      targets_.push_back(setup_.make_targets(test_case));
    }
    RandomStream random("test/sim/articulated/jobs", 0);
    for (std::size_t i = 0; i < 200; ++i) {
      TrackingJob job = make_job(*designs[i % 5], targets_[i / 5]);
      job.cutoff_m = random.uniform(0, 1) < 0.4 ? random.uniform(0.0001, 0.5) : kNever;
      job.abandon_above_m = random.uniform(0, 1) < 0.3 ? random.uniform(0.0001, 0.1) : kNever;
      job.recording = {random.uniform(0, 1) < 0.2, random.uniform(0, 1) < 0.1};
      jobs_.push_back(job);
    }
  }

  // Returns the results of jobs_[order[k]], simulated in batches of `size`.
  std::vector<TrackingResult> simulate(const PhysicsEngine& engine,
                                       const std::vector<std::size_t>& order,
                                       std::size_t size) const {
    std::vector<TrackingResult> results;
    for (std::size_t first = 0; first < order.size(); first += size) {
      std::vector<TrackingJob> batch;
      for (std::size_t k = first; k < std::min(first + size, order.size()); ++k) {
        batch.push_back(jobs_[order[k]]);
      }
      for (TrackingResult& result : engine.simulate(setup_, batch)) {
        results.push_back(std::move(result));
      }
    }
    return results;
  }

  TrackingSetup setup_{load_irb4600(), make_e6_task()};
  std::vector<TargetTable> targets_;
  std::vector<TrackingJob> jobs_;
};

TEST_F(TwoHundredJobs, HaveTheSameResultsAloneAndInAnyCompany) {
  std::vector<std::size_t> order(jobs_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::vector<std::size_t> shuffled = order;
  RandomStream random("test/sim/articulated/order", 0);
  for (std::size_t i = shuffled.size(); i-- > 1;) {
    const double place = random.uniform(0, static_cast<double>(i + 1));
    std::swap(shuffled[i], shuffled[static_cast<std::size_t>(place)]);
  }
  const std::vector<std::size_t> reversed(order.rbegin(), order.rend());
  for (const EngineOptions& options : make_all_options()) {
    const auto engine = make_articulated(options);
    const auto alone = simulate(*engine, order, 1);
    for (const auto status :
         {SimulationStatus::ok, SimulationStatus::cut_off, SimulationStatus::diverged,
          SimulationStatus::unreachable, SimulationStatus::abandoned}) {
      EXPECT_GT(std::count_if(alone.begin(), alone.end(),
                              [&](const TrackingResult& r) { return r.status == status; }),
                3)
          << to_string(status);
    }
    for (const std::size_t size : {3, 35, 64, 200}) {
      for (const auto& some : {order, reversed, shuffled}) {
        const auto together = simulate(*engine, some, size);
        ASSERT_EQ(together.size(), some.size());
        for (std::size_t k = 0; k < some.size(); ++k) {
          SCOPED_TRACE(testing::Message() << describe(options) << ", batches of " << size
                                          << ", job " << some[k] << " as number " << k);
          expect_identical(together[k], alone[some[k]]);
        }
      }
    }
  }
}

TEST_F(TwoHundredJobs, AreNotChangedByRecording) {
  for (const EngineOptions& options : make_all_options()) {
    const auto engine = make_articulated(options);
    for (TrackingJob& job : jobs_) {
      job.recording = {};
    }
    const auto plain = engine->simulate(setup_, jobs_);
    for (std::size_t i = 0; i < jobs_.size(); ++i) {
      jobs_[i].recording = {i % 3 != 0, i % 2 != 0};
    }
    auto recorded = engine->simulate(setup_, jobs_);
    for (std::size_t i = 0; i < jobs_.size(); ++i) {
      SCOPED_TRACE(testing::Message() << describe(options) << ", job " << i);
      const auto steps = static_cast<std::size_t>(plain[i].steps);
      EXPECT_EQ(recorded[i].error_series_m.size(), i % 3 != 0 ? steps : 0U);
      EXPECT_EQ(recorded[i].trajectory.size(), i % 2 != 0 ? steps : 0U);
      recorded[i].error_series_m.clear();
      recorded[i].trajectory.clear();
      expect_identical(recorded[i], plain[i]);
    }
  }
}

// Arms of different masses and lengths in one batch. The elbow of one arm turns in the opposite
// direction, so its axes are opposite where those of the others are parallel.
class OwnArms : public testing::Test {
 protected:
  explicit OwnArms(bool with_opposite_axis = false) {
    for (std::uint64_t number = 0; number < 12; ++number) {
      RandomStream random("test/sim/articulated/arms", number);
      RobotModel robot = load_irb4600();
      for (std::size_t i = 0; i < robot.joint_count(); ++i) {
        Inertial& body = robot.links[i].inertial;
        const double scale = random.uniform(0.9, 1.1);
        body.mass_kg *= scale;
        body.inertia_kg_m2 *= scale;
        robot.joints[i].origin.translation() *= random.uniform(0.98, 1.02);
      }
      if (with_opposite_axis && number % 5 == 1) {
        robot.joints[2].axis *= -1;
      }
      setups_.emplace_back(robot, make_e6_task());
      targets_.push_back(setups_.back().make_targets(make_case(number, 4)));
      EXPECT_EQ(targets_.back().unreachable, "");
    }
    for (std::size_t i = 0; i < setups_.size(); ++i) {
      jobs_.push_back(make_job(kTableA10, targets_[i]));
      jobs_.back().setup = &setups_[i];
    }
    jobs_.push_back(make_job(kTableA10, targets_[0]));  // has the arm of the call
  }

  void expect_as_alone() const {
    for (const EngineOptions& options : make_all_options()) {
      const auto engine = make_articulated(options);
      const auto together = engine->simulate(common_, jobs_);
      for (std::size_t i = 0; i < jobs_.size(); ++i) {
        SCOPED_TRACE(testing::Message() << describe(options) << ", job " << i);
        TrackingJob job = jobs_[i];
        job.setup = nullptr;
        const TrackingSetup& setup = i < setups_.size() ? setups_[i] : common_;
        expect_identical(together[i], simulate_alone(*engine, setup, job));
      }
    }
  }

  TrackingSetup common_{load_irb4600(), make_e6_task()};
  std::vector<TrackingSetup> setups_;
  std::vector<TargetTable> targets_;
  std::vector<TrackingJob> jobs_;
};

class ArmsOfOtherShapes : public OwnArms {
 protected:
  ArmsOfOtherShapes() : OwnArms(true) {}
};

TEST_F(OwnArms, SideBySideDoAsAlone) {
  expect_as_alone();
}

TEST_F(ArmsOfOtherShapes, SideBySideDoAsAlone) {
  expect_as_alone();
}

// One per cent of the mean. With so few points, the error of a case varies by some per cent.
TEST_F(ArmsOfOtherShapes, AgreeWithOde) {
  const auto results = make_articulated()->simulate(common_, jobs_);
  const auto reference = make_engine("ode")->simulate(common_, jobs_);
  const double mean_m = calc_mean_m(reference);
  EXPECT_NEAR(calc_mean_m(results), mean_m, 0.01 * mean_m);
  for (std::size_t i = 0; i < jobs_.size(); ++i) {
    EXPECT_EQ(results[i].steps, reference[i].steps) << i;
    EXPECT_NEAR(results[i].energy_j, reference[i].energy_j, 0.01 * reference[i].energy_j) << i;
    EXPECT_NEAR(results[i].mean_error_m, reference[i].mean_error_m,
                0.05 * reference[i].mean_error_m)
        << i;
  }
}

}  // namespace
}  // namespace armwright
