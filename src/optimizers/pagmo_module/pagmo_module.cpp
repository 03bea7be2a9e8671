#include "optimizers/pagmo_module/pagmo_module.hpp"

#include <functional>
#include <memory>
#include <optional>
#include <pagmo/algorithm.hpp>
#include <pagmo/algorithms/bee_colony.hpp>
#include <pagmo/algorithms/cmaes.hpp>
#include <pagmo/algorithms/compass_search.hpp>
#include <pagmo/algorithms/de.hpp>
#include <pagmo/algorithms/de1220.hpp>
#include <pagmo/algorithms/gaco.hpp>
#include <pagmo/algorithms/gwo.hpp>
#include <pagmo/algorithms/ihs.hpp>
#include <pagmo/algorithms/maco.hpp>
#include <pagmo/algorithms/mbh.hpp>
#include <pagmo/algorithms/moead.hpp>
#include <pagmo/algorithms/nsga2.hpp>
#include <pagmo/algorithms/nspso.hpp>
#include <pagmo/algorithms/pso.hpp>
#include <pagmo/algorithms/pso_gen.hpp>
#include <pagmo/algorithms/sade.hpp>
#include <pagmo/algorithms/sea.hpp>
#include <pagmo/algorithms/sga.hpp>
#include <pagmo/algorithms/simulated_annealing.hpp>
#include <pagmo/algorithms/xnes.hpp>
#include <pagmo/batch_evaluators/member_bfe.hpp>
#include <pagmo/bfe.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>

namespace armwright {
namespace {

// Value of pagmo's option `memory`: off. A search keeps no state between runs.
constexpr bool kMemory = false;
// Tolerances of the differential evolutions: off. They would end when the population has become
// flat; evolve() is called again anyway, and ending would only lose their adapted parameters.
constexpr double kNoTolerance = 0;
// Stop criteria of the ant colonies that must never apply.
constexpr unsigned kNever = 1'000'000'000;
// The value with which pagmo chooses the parameter.
constexpr double kAutomatic = -1;

// The options of one row in the types of pagmo.
class Reader {
 public:
  explicit Reader(const PagmoOptions& options) : options_(options) {}
  double number(const std::string& name) const { return std::get<double>(options_.at(name)); }
  unsigned count(const std::string& name) const {
    return static_cast<unsigned>(std::get<std::int64_t>(options_.at(name)));
  }
  bool flag(const std::string& name) const { return std::get<bool>(options_.at(name)); }
  const std::string& text(const std::string& name) const {
    return std::get<std::string>(options_.at(name));
  }

 private:
  const PagmoOptions& options_;
};

using Maker = std::function<pagmo::algorithm(const Reader&, const PagmoPlan&)>;

template <typename Method>
pagmo::algorithm with_batches(Method method) {
  method.set_bfe(pagmo::bfe{pagmo::member_bfe{}});
  return pagmo::algorithm{method};
}

pagmo::compass_search make_compass_search(const Reader& read) {
  return pagmo::compass_search{kNever, read.number("start_range"), read.number("stop_range"),
                               read.number("reduction_coeff")};
}

template <typename Swarm>
Swarm make_swarm(const Reader& read, const PagmoPlan& plan) {
  return Swarm{plan.generations,
               read.number("omega"),
               read.number("eta1"),
               read.number("eta2"),
               read.number("max_vel"),
               read.count("variant"),
               read.count("neighb_type"),
               read.count("neighb_param"),
               kMemory,
               plan.seed};
}

const std::map<std::string, Maker>& single_objective_makers() {
  static const std::map<std::string, Maker> makers = {
      {"gaco",
       [](const Reader& read, const PagmoPlan& plan) {
         return with_batches(pagmo::gaco{plan.generations, read.count("ker"), read.number("q"),
                                         read.number("oracle"), read.number("acc"),
                                         read.count("threshold"), read.count("n_gen_mark"), kNever,
                                         kNever, read.number("focus"), kMemory, plan.seed});
       }},
      {"de",
       [](const Reader& read, const PagmoPlan& plan) {
         return pagmo::algorithm{pagmo::de{plan.generations, read.number("F"), read.number("CR"),
                                           read.count("variant"), kNoTolerance, kNoTolerance,
                                           plan.seed}};
       }},
      {"sade",
       [](const Reader& read, const PagmoPlan& plan) {
         return pagmo::algorithm{pagmo::sade{plan.generations, read.count("variant"),
                                             read.count("variant_adptv"), kNoTolerance,
                                             kNoTolerance, kMemory, plan.seed}};
       }},
      {"de1220",
       [](const Reader& read, const PagmoPlan& plan) {
         return pagmo::algorithm{pagmo::de1220{
             plan.generations, pagmo::de1220_statics<void>::allowed_variants,
             read.count("variant_adptv"), kNoTolerance, kNoTolerance, kMemory, plan.seed}};
       }},
      {"gwo",
       [](const Reader&, const PagmoPlan& plan) {
         return pagmo::algorithm{pagmo::gwo{plan.generations, plan.seed}};
       }},
      {"ihs",
       [](const Reader& read, const PagmoPlan& plan) {
         return pagmo::algorithm{pagmo::ihs{
             plan.generations, read.number("phmcr"), read.number("ppar_min"),
             read.number("ppar_max"), read.number("bw_min"), read.number("bw_max"), plan.seed}};
       }},
      {"pso",
       [](const Reader& read, const PagmoPlan& plan) {
         return pagmo::algorithm{make_swarm<pagmo::pso>(read, plan)};
       }},
      {"pso_gen",
       [](const Reader& read, const PagmoPlan& plan) {
         return with_batches(make_swarm<pagmo::pso_gen>(read, plan));
       }},
      {"sea",
       [](const Reader&, const PagmoPlan& plan) {
         return pagmo::algorithm{pagmo::sea{plan.generations, plan.seed}};
       }},
      {"sga",
       [](const Reader& read, const PagmoPlan& plan) {
         return pagmo::algorithm{
             pagmo::sga{plan.generations, read.number("cr"), read.number("eta_c"), read.number("m"),
                        read.number("param_m"), read.count("param_s"), read.text("crossover"),
                        read.text("mutation"), read.text("selection"), plan.seed}};
       }},
      {"simulated_annealing",
       [](const Reader& read, const PagmoPlan& plan) {
         return pagmo::algorithm{pagmo::simulated_annealing{
             plan.scale * read.number("Ts"), plan.scale * read.number("Tf"), plan.generations,
             read.count("n_range_adj"), read.count("bin_size"), read.number("start_range"),
             plan.seed}};
       }},
      {"bee_colony",
       [](const Reader& read, const PagmoPlan& plan) {
         return pagmo::algorithm{
             pagmo::bee_colony{plan.generations, read.count("limit"), plan.seed}};
       }},
      {"cmaes",
       [](const Reader& read, const PagmoPlan& plan) {
         const bool force_bounds = true;
         return pagmo::algorithm{pagmo::cmaes{plan.generations, kAutomatic, kAutomatic, kAutomatic,
                                              kAutomatic, read.number("sigma0"),
                                              read.number("ftol"), read.number("xtol"), kMemory,
                                              force_bounds, plan.seed}};
       }},
      {"xnes",
       [](const Reader& read, const PagmoPlan& plan) {
         const bool force_bounds = true;
         return pagmo::algorithm{pagmo::xnes{
             plan.generations, kAutomatic, kAutomatic, kAutomatic, read.number("sigma0"),
             read.number("ftol"), read.number("xtol"), kMemory, force_bounds, plan.seed}};
       }},
      {"compass_search",
       [](const Reader& read, const PagmoPlan&) {
         return pagmo::algorithm{make_compass_search(read)};
       }},
      {"mbh",
       [](const Reader& read, const PagmoPlan& plan) {
         return pagmo::algorithm{
             pagmo::mbh{make_compass_search(read), kNever, read.number("perturb"), plan.seed}};
       }},
  };
  return makers;
}

const std::map<std::string, Maker>& multi_objective_makers() {
  static const std::map<std::string, Maker> makers = {
      {"nsga2",
       [](const Reader& read, const PagmoPlan& plan) {
         return with_batches(pagmo::nsga2{plan.generations, read.number("cr"), read.number("eta_c"),
                                          read.number("m"), read.number("eta_m"), plan.seed});
       }},
      {"moead",
       [](const Reader& read, const PagmoPlan& plan) {
         return pagmo::algorithm{
             pagmo::moead{plan.generations, read.text("weight_generation"),
                          read.text("decomposition"), read.count("neighbours"), read.number("CR"),
                          read.number("F"), read.number("eta_m"), read.number("realb"),
                          read.count("limit"), read.flag("preserve_diversity"), plan.seed}};
       }},
      {"maco",
       [](const Reader& read, const PagmoPlan& plan) {
         return with_batches(pagmo::maco{plan.generations, read.count("ker"), read.number("q"),
                                         read.count("threshold"), read.count("n_gen_mark"), kNever,
                                         read.number("focus"), kMemory, plan.seed});
       }},
      {"nspso",
       [](const Reader& read, const PagmoPlan& plan) {
         return with_batches(pagmo::nspso{
             plan.generations, read.number("omega"), read.number("c1"), read.number("c2"),
             read.number("chi"), read.number("v_coeff"), read.count("leader_selection_range"),
             read.text("diversity_mechanism"), kMemory, plan.seed});
       }},
  };
  return makers;
}

const Maker& find_maker(const std::string& algorithm) {
  const auto single = single_objective_makers().find(algorithm);
  return single != single_objective_makers().end() ? single->second
                                                   : multi_objective_makers().at(algorithm);
}

// The problem as pagmo needs it: default-constructible and copyable. All copies share the problem of
// the program. pagmo calls the counts on a default-constructed object as well.
struct BridgedProblem {
  PagmoProblem* problem = nullptr;

  std::vector<double> fitness(const std::vector<double>& point) const {
    return problem->evaluate({&point, 1}).front();
  }
  // Evaluates many points. pagmo stores points and fitness vectors one after the other in one
  // vector.
  std::vector<double> batch_fitness(const std::vector<double>& all) const {
    const auto dimension = static_cast<std::ptrdiff_t>(problem->bounds().first.size());
    std::vector<std::vector<double>> points;
    for (auto from = all.begin(); from != all.end(); from += dimension) {
      points.emplace_back(from, from + dimension);
    }
    std::vector<double> joined;
    for (const std::vector<double>& one : problem->evaluate(points)) {
      joined.insert(joined.end(), one.begin(), one.end());
    }
    return joined;
  }

  std::pair<std::vector<double>, std::vector<double>> get_bounds() const {
    return problem->bounds();
  }
  std::size_t get_nobj() const { return problem == nullptr ? 1 : problem->objective_count(); }
  std::size_t get_nic() const { return problem == nullptr ? 0 : problem->constraint_count(); }
  std::size_t get_nix() const { return problem == nullptr ? 0 : problem->integer_count(); }
};

class Search : public PagmoSearch {
 public:
  Search(const std::string& algorithm, const PagmoOptions& options)
      : maker_(find_maker(algorithm)), options_(options) {
    plan({});
  }

  void begin(PagmoProblem& problem, unsigned seed) override {
    population_.emplace(pagmo::problem{BridgedProblem{&problem}}, 0, seed);
  }
  void add(const std::vector<double>& point, const std::vector<double>& fitness) override {
    population_->push_back(point, fitness);
  }
  void plan(const PagmoPlan& plan) override { algorithm_ = maker_(Reader(options_), plan); }
  void evolve() override { population_ = algorithm_->evolve(*population_); }

 private:
  const Maker& maker_;
  PagmoOptions options_;
  std::optional<pagmo::algorithm> algorithm_;
  std::optional<pagmo::population> population_;
};

}  // namespace
}  // namespace armwright

extern "C" {

[[gnu::visibility("default")]] extern const char armwright_module_id[];
const char armwright_module_id[] = ARMWRIGHT_MODULE_ID;

[[gnu::visibility("default")]] armwright::MakePagmoSearch armwright_make_pagmo_search;
armwright::PagmoSearch* armwright_make_pagmo_search(const std::string& algorithm,
                                                    const armwright::PagmoOptions& options) {
  return std::make_unique<armwright::Search>(algorithm, options).release();
}
}
