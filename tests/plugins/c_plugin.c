/* The border in C: walks along the diagonal of the box and well beyond it, ten points at a time,
 * for as long as it is answered. */
#include <stdio.h>
#include <stdlib.h>

#include "armwright/plugin.h"

enum { BATCH = 10 };

static int minimize(const struct armwright_problem* problem,
                    const struct armwright_evaluator* evaluator,
                    const struct armwright_options* options, uint64_t seed, char* message,
                    size_t message_size) {
  const size_t n = problem->dimension;
  const double step = options->get_number(options->context, "step");
  double* points = malloc(BATCH * n * sizeof *points);
  double* objectives = malloc(BATCH * problem->objective_count * sizeof *objectives);
  int32_t statuses[BATCH];
  size_t i, j, k;
  (void)seed;
  if (points == NULL || objectives == NULL) {
    snprintf(message, message_size, "no memory");
    return 1;
  }
  for (k = 0; !evaluator->stopped(evaluator->context); k += BATCH) {
    for (i = 0; i < BATCH; ++i) {
      for (j = 0; j < n; ++j) {
        points[i * n + j] =
            problem->lower[j] + step * (double)(k + i) * (problem->upper[j] - problem->lower[j]);
      }
    }
    if (evaluator->evaluate(evaluator->context, points, BATCH, objectives, NULL, statuses) <
        BATCH) {
      break;
    }
  }
  free(points);
  free(objectives);
  return 0;
}

static const struct armwright_option options[] = {{.name = "step",
                                                   .description = "share of the box",
                                                   .type = ARMWRIGHT_NUMBER,
                                                   .fallback = 0.1,
                                                   .lower = 0,
                                                   .upper = 1}};

static const struct armwright_plugin plugin = {.abi = ARMWRIGHT_PLUGIN_ABI,
                                               .struct_size = sizeof(struct armwright_plugin),
                                               .name = "diagonal",
                                               .summary = "Walks along the diagonal",
                                               .source = "the tests",
                                               .capabilities = ARMWRIGHT_BATCH,
                                               .options = options,
                                               .option_count = 1,
                                               .minimize = minimize};

ARMWRIGHT_PLUGIN_EXPORT const struct armwright_plugin* armwright_plugin(void) {
  return &plugin;
}
