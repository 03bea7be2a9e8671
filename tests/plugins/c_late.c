/* Shows in C what armwright gives since version 2.0, as late.cpp does in C++. */
#include <stdlib.h>
#include <string.h>

#include "armwright/plugin.h"

static void show(const struct armwright_problem* problem,
                 const struct armwright_evaluator* evaluator, double* x, double first,
                 double second) {
  memcpy(x, problem->start, problem->dimension * sizeof *x);
  x[0] = first;
  x[1] = second;
  evaluator->recommend(evaluator->context, x);
}

static int minimize(const struct armwright_problem* problem,
                    const struct armwright_evaluator* evaluator,
                    const struct armwright_options* options, uint64_t seed, char* message,
                    size_t message_size) {
  const size_t n = problem->dimension;
  double* points = malloc(2 * n * sizeof *points);
  double* objectives = malloc(2 * problem->objective_count * sizeof *objectives);
  const double* residuals;
  double squares = 0;
  size_t count = 0;
  size_t i;
  int first_clipped, second_clipped;
  (void)options;
  (void)seed;
  if (points == NULL || objectives == NULL) {
    free(points);
    free(objectives);
    return 1;
  }
  memcpy(points, problem->start, n * sizeof *points);
  memcpy(points + n, problem->start, n * sizeof *points);
  points[n] = 2 * problem->upper[0] + 1;
  if (evaluator->evaluate(evaluator->context, points, 2, objectives, NULL, NULL) == 2) {
    residuals = evaluator->residuals(evaluator->context, 0, &count);
    for (i = 0; i < count; ++i) {
      squares += residuals[i] * residuals[i];
    }
    first_clipped = evaluator->is_clipped(evaluator->context, 0);
    second_clipped = evaluator->is_clipped(evaluator->context, 1);
    show(problem, evaluator, points, armwright_scalar(problem, objectives),
         armwright_scalar(problem, objectives));
    show(problem, evaluator, points, (double)problem->has_residuals, squares);
    show(problem, evaluator, points, first_clipped, second_clipped);
    /* No such point: nothing is read beyond the scores. */
    if (evaluator->residuals(evaluator->context, 2, &count) != NULL || count != 0) {
      strncpy(message, "there are residuals of a point that was not asked for", message_size);
      free(points);
      free(objectives);
      return 2;
    }
  }
  memcpy(points, problem->start, n * sizeof *points);
  while (evaluator->evaluate(evaluator->context, points, 1, NULL, NULL, NULL) == 1) {
  }
  for (i = 0; i < n; ++i) {
    points[i] = 0;
  }
  evaluator->recommend(evaluator->context, points);
  free(points);
  free(objectives);
  return 0;
}

static const struct armwright_plugin plugin = {
    .abi = ARMWRIGHT_PLUGIN_ABI,
    .struct_size = sizeof(struct armwright_plugin),
    .name = "c_late",
    .summary = "Recommends after the end of the budget",
    .source = "the tests",
    .capabilities = ARMWRIGHT_BATCH | ARMWRIGHT_RESIDUALS,
    .minimize = minimize,
    .least_variables = 2};

ARMWRIGHT_PLUGIN_EXPORT const struct armwright_plugin* armwright_plugin(void) {
  return &plugin;
}
