// A problem with everything: types of variables, two objectives, a constraint, a metric, several
// cases, records and batches.
#include <cmath>

#include "armwright/problem.hpp"

namespace {

using namespace armwright::problem;

class Mixed : public Problem {
 public:
  Description describe() const override {
    Description all;
    all.name = "mixed";
    all.summary = "A library with everything";
    all.variables = {real("gain", "N m", -2, 6), logarithmic("time", "s", 0.01, 100),
                     integer("teeth", "", 8, 40), category("metal", {"steel", "brass", "lead"})};
    all.variables[2].start = 12;
    all.objectives = {{"cost", "EUR", false, 1, 1000.0}, {"speed", "m/s", true, 2, 0.0, 1e6}};
    all.constraints = {{"mass", "kg", 40}};
    all.metrics = {{"price", "EUR"}};
    all.has_records = true;
    all.has_batches = true;
    all.training_cases = ARMWRIGHT_ANY_CASES;
    all.validation_cases = 3;
    all.test_cases = 4;
    return all;
  }

  Answer evaluate(const Point& x, const Case& one) override {
    const double metal = x.word("metal") == "steel" ? 1 : x.word(3) == "brass" ? 2 : 3;
    const double part = static_cast<double>(one.seed % 7) + static_cast<double>(one.number);
    if (x[0] < -1) {
      throw std::runtime_error("the gain is too small");
    }
    Answer answer;
    answer.objectives = {x.get("gain") * x[0] + metal + part, x[2] + std::log(x[1])};
    answer.constraints = {metal * x.get("teeth")};
    answer.metrics = {metal * 10};
    return answer;
  }

  std::vector<Answer> evaluate_batch(const std::vector<Question>& questions) override {
    if (questions.size() > 1000) {
      throw Broken("asked more than 1000 questions at once");
    }
    return Problem::evaluate_batch(questions);
  }

  Record record(const Point& x, const Case& one) override {
    Record record;
    record.abscissa = {"time", "s", {0, 1, 2}};
    record.series = {{"angle", "rad", {x[0], x[0] / 2, static_cast<double>(one.number)}}};
    record.files = {{"note.txt", std::string(one.set) + "\n"}};
    return record;
  }
};

}  // namespace

ARMWRIGHT_PROBLEM(Mixed)
