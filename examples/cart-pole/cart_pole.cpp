// A cart balances a pole in MuJoCo. Four gains of a state feedback are tuned: cart and pole shall come to
// rest quickly and with little force. Each case begins with another angle of the pole.
#include <mujoco/mujoco.h>

#include <armwright/problem.hpp>
#include <cmath>
#include <random>

namespace aw = armwright::problem;

class CartPole : public aw::Problem {
 public:
  CartPole() {
    char error[500] = "";
    model_ = mj_loadXML(CART_POLE_MODEL, nullptr, error, sizeof error);
    error_ = error;
    data_ = model_ == nullptr ? nullptr : mj_makeData(model_);
  }

  aw::Description describe() const override {
    aw::Description all;
    all.name = "cart-pole";
    all.summary = "Balance a pole on a cart";
    // The search starts in the middle of the bounds, where the pole stands and the cart drifts.
    all.variables = {aw::real("k_position", "N/m", -50, 50), aw::real("k_speed", "N s/m", -50, 50),
                     aw::real("k_angle", "N/rad", -80, 200),
                     aw::real("k_turn", "N s/rad", -30, 50)};
    all.objectives = {{"cost"}};
    all.objectives[0].penalty = 1e4;
    all.metrics = {{"peak_force", "N"}};
    all.training_cases = 5;
    all.validation_cases = all.test_cases = 10;
    return all;
  }

  aw::Answer evaluate(const aw::Point& k, const aw::Case& one) override {
    if (data_ == nullptr) {
      throw aw::Broken(error_);
    }
    mj_resetData(model_, data_);
    std::mt19937_64 random(one.seed);
    data_->qpos[1] = (static_cast<double>(random() >> 11) * 0x1p-53 - 0.5) * 0.4;  // rad
    double cost = 0, peak = 0;
    while (data_->time < 5) {
      const double* q = data_->qpos;
      const double* v = data_->qvel;
      const double force =
          std::fmin(std::fmax(k[0] * q[0] + k[1] * v[0] + k[2] * q[1] + k[3] * v[1], -20), 20);
      data_->ctrl[0] = force;
      mj_step(model_, data_);
      if (!(std::fabs(q[1]) < 1.5)) {
        return aw::Answer::failed("the pole falls");
      }
      cost += (q[0] * q[0] + 5 * q[1] * q[1] + 1e-4 * force * force) * model_->opt.timestep;
      peak = std::fmax(peak, std::fabs(force));
    }
    aw::Answer answer(cost);
    answer.metrics = {peak};
    return answer;
  }

 private:
  mjModel* model_ = nullptr;
  mjData* data_ = nullptr;
  std::string error_;
};

ARMWRIGHT_PROBLEM(CartPole)
