/* A fit in C99, the border's own language: two residuals, whose squares are the objective. */
#include <armwright/problem.h>
#include <math.h>
#include <stdio.h>

static void evaluate(void* context, const struct armwright_case* question,
                     struct armwright_answer* answer) {
  const double residuals[2] = {question->x[0] - 1, 10 * (question->x[1] - question->x[0])};
  (void)context;
  if (question->x[0] > 4) {
    answer->status = ARMWRIGHT_CASE_DIVERGED;
    snprintf(answer->reason, answer->reason_size, "a is %g", question->x[0]);
    return;
  }
  answer->objectives[0] = residuals[0] * residuals[0] + residuals[1] * residuals[1];
  if (question->wants_residuals) {
    answer->set_residuals(answer, residuals, 2);
  }
}

static struct armwright_variable variables[] = {{.name = "a", .lower = -5, .upper = 5},
                                                {.name = "b", .lower = -5, .upper = 5, .start = 2}};
static const struct armwright_objective objectives[] = {{.name = "misfit"}};
static struct armwright_user_problem problem = {.abi = ARMWRIGHT_PROBLEM_ABI,
                                                .struct_size = sizeof problem,
                                                .name = "fit",
                                                .summary = "Two residuals",
                                                .variables = variables,
                                                .variable_count = 2,
                                                .objectives = objectives,
                                                .objective_count = 1,
                                                .has_residuals = 1,
                                                .evaluate = evaluate};

ARMWRIGHT_PROBLEM_EXPORT const struct armwright_user_problem* armwright_user_problem(void) {
  return &problem;
}
