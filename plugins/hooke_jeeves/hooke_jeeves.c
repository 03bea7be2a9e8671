/* Pattern search (Hooke and Jeeves 1961, "Direct search" solution of numerical and statistical
 * problems). The search makes steps along one variable at a time from a base point. If they
 * improve the point, it repeats the whole move once before the next steps. If they do not, it
 * shortens the steps.
 *
 * The search works in coordinates: a linear variable is its own coordinate, and the coordinate of
 * a logarithmic variable is the logarithm of its magnitude. Steps are fractions of the box in
 * coordinates. Constraints are added to the objective as an exact penalty.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "armwright/plugin.h"

struct search {
  const struct armwright_problem* problem;
  const struct armwright_evaluator* evaluator;
  double violation_weight;
  double* lower; /* bounds, in coordinates */
  double* upper;
  double* point;
  double* objectives;
  double* constraints;
  int is_over;
};

static double clamp(double value, double lower, double upper) {
  return fmin(fmax(value, lower), upper);
}

static double to_coordinate(const struct search* s, size_t i, double x) {
  return s->problem->is_logarithmic[i] ? log(fabs(x)) : x;
}

static double to_variable(const struct search* s, size_t i, double coordinate) {
  const struct armwright_problem* problem = s->problem;
  double x = coordinate;
  if (problem->is_logarithmic[i]) {
    x = copysign(exp(coordinate), problem->lower[i]);
  }
  return clamp(x, problem->lower[i], problem->upper[i]);
}

/* Returns the value to minimise. At the end of the run it is infinite, so no point is accepted. */
static double calc_merit(struct search* s, const double* coordinates) {
  int32_t status = ARMWRIGHT_OK;
  double merit;
  size_t i;
  if (s->is_over) {
    return INFINITY;
  }
  for (i = 0; i < s->problem->dimension; ++i) {
    s->point[i] = to_variable(s, i, coordinates[i]);
  }
  if (s->evaluator->evaluate(s->evaluator->context, s->point, 1, s->objectives, s->constraints,
                             &status) < 1) {
    s->is_over = 1;
    return INFINITY;
  }
  merit = armwright_scalar(s->problem, s->objectives);
  for (i = 0; status == ARMWRIGHT_OK && i < s->problem->constraint_count; ++i) {
    merit += s->violation_weight * fmax(0, s->constraints[i]);
  }
  return merit;
}

/* Tries a step up and a step down along each variable in turn, and keeps a step that improves x.
 * Returns the merit of the new x. */
static double explore(struct search* s, double* x, double merit, double step) {
  size_t i;
  for (i = 0; i < s->problem->dimension; ++i) {
    const double before = x[i];
    int direction;
    for (direction = 1; direction >= -1; direction -= 2) {
      double trial;
      x[i] =
          clamp(before + direction * step * (s->upper[i] - s->lower[i]), s->lower[i], s->upper[i]);
      trial = x[i] == before ? INFINITY : calc_merit(s, x);
      if (trial < merit) {
        merit = trial;
        break;
      }
      x[i] = before;
    }
  }
  return merit;
}

static void run(struct search* s, double step, double shortest_step, double factor, double* base,
                double* x, double* earlier) {
  const size_t n = s->problem->dimension;
  double merit;
  size_t i;
  for (i = 0; i < n; ++i) {
    base[i] = to_coordinate(s, i, s->problem->start[i]);
  }
  merit = calc_merit(s, base);
  while (!s->is_over && step >= shortest_step) {
    double explored;
    memcpy(x, base, n * sizeof(double));
    explored = explore(s, x, merit, step);
    if (!(explored < merit)) {
      step *= factor;
      continue;
    }
    while (explored < merit && !s->is_over) { /* pattern moves while they improve */
      merit = explored;
      memcpy(earlier, base, n * sizeof(double));
      memcpy(base, x, n * sizeof(double));
      for (i = 0; i < n; ++i) {
        x[i] = clamp(2 * base[i] - earlier[i], s->lower[i], s->upper[i]);
      }
      explored = explore(s, x, calc_merit(s, x), step);
    }
  }
}

static int minimize(const struct armwright_problem* problem,
                    const struct armwright_evaluator* evaluator,
                    const struct armwright_options* options, uint64_t seed, char* message,
                    size_t message_size) {
  const size_t n = problem->dimension;
  double* memory =
      calloc(6 * n + problem->objective_count + problem->constraint_count, sizeof(double));
  struct search s;
  size_t i;
  (void)seed; /* the method uses no random numbers */
  if (memory == NULL) {
    snprintf(message, message_size, "no memory for %zu variables", n);
    return 1;
  }
  s.problem = problem;
  s.evaluator = evaluator;
  s.violation_weight = options->get_number(options->context, "violation_weight");
  s.lower = memory;
  s.upper = memory + n;
  s.point = memory + 2 * n;
  s.objectives = memory + 6 * n;
  s.constraints = s.objectives + problem->objective_count;
  s.is_over = 0;
  for (i = 0; i < n; ++i) {
    const double a = to_coordinate(&s, i, problem->lower[i]);
    const double b = to_coordinate(&s, i, problem->upper[i]);
    s.lower[i] = fmin(a, b); /* a < b does not hold for negative variables */
    s.upper[i] = fmax(a, b);
  }
  run(&s, options->get_number(options->context, "step"),
      options->get_number(options->context, "shortest_step"),
      options->get_number(options->context, "factor"), memory + 3 * n, memory + 4 * n,
      memory + 5 * n);
  free(memory);
  return 0;
}

static const struct armwright_option kOptions[] = {
    {"step", "first step, as a share of the box", ARMWRIGHT_NUMBER, 0.05, 1e-9, 1, NULL, NULL},
    {"shortest_step", "it ends when the step is shorter", ARMWRIGHT_NUMBER, 1e-9, 1e-15, 1, NULL,
     NULL},
    {"factor", "by which steps are shortened", ARMWRIGHT_NUMBER, 0.5, 0.01, 0.99, NULL, NULL},
    {"violation_weight", "of violated constraints, added to the first objective", ARMWRIGHT_NUMBER,
     1e6, 0, 1e15, NULL, NULL}};

static const struct armwright_plugin kPlugin = {
    .abi = ARMWRIGHT_PLUGIN_ABI,
    .struct_size = sizeof(struct armwright_plugin),
    .name = "hooke-jeeves",
    .summary = "Pattern search: steps along one variable at a time, and the whole move again",
    .source =
        "Hooke and Jeeves 1961, \"Direct search\" solution of numerical and statistical problems",
    .capabilities = ARMWRIGHT_BOUNDS | ARMWRIGHT_LOCAL,
    .options = kOptions,
    .option_count = sizeof(kOptions) / sizeof(kOptions[0]),
    .minimize = minimize};

ARMWRIGHT_PLUGIN_EXPORT const struct armwright_plugin* armwright_plugin(void) {
  return &kPlugin;
}
