/* An optimizer for armwright as a shared library, in C99 or anything that can call and be called
 * like it. This header stands alone; C++ authors find plugin.hpp more comfortable.
 *
 * A plugin exports one function, armwright_plugin(), which returns a description of the optimizer:
 * its name, what it can do, its options, and a function minimize(). armwright opens the library in
 * a process of its own, so a crash costs the run and not the program.
 *
 *     armwright optimize q1-complex --optimizer ./libmine.so
 *
 * Everything that crosses the border is a plain struct that begins with its size. Later versions of
 * armwright may append fields; they never change or remove any without a new ARMWRIGHT_PLUGIN_ABI.
 * A plugin that was built with an earlier version of this header runs unchanged. A field marked
 * "since 2.0" is there if struct_size is larger than its offset. Texts are UTF-8 and end with a zero byte. No pointer that armwright hands over outlives the call.
 */
#ifndef ARMWRIGHT_PLUGIN_H
#define ARMWRIGHT_PLUGIN_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The version of what this header describes. armwright refuses plugins of another one. */
#define ARMWRIGHT_PLUGIN_ABI 1u

/* Marks the one function that a plugin exports, also where everything else is hidden. */
#if defined(_WIN32)
#define ARMWRIGHT_PLUGIN_EXPORT __declspec(dllexport)
#else
#define ARMWRIGHT_PLUGIN_EXPORT __attribute__((visibility("default")))
#endif

/* What the optimizer can do, for armwright_plugin::capabilities. Be honest: the table of optimizers
 * shows them, some are checked, and schedules and comparisons rely on them. */
enum {
  ARMWRIGHT_BOUNDS = 1u << 0,          /* never asks for a point outside the box: checked. Without
                                          it such points are evaluated at the nearest inside */
  ARMWRIGHT_CONSTRAINTS = 1u << 1,     /* uses constraint values */
  ARMWRIGHT_MULTI_OBJECTIVE = 1u << 2, /* uses more than the first objective */
  ARMWRIGHT_BATCH = 1u << 3,           /* asks for several points at a time: they run in parallel */
  ARMWRIGHT_NOISY = 1u << 4,           /* copes with objectives that change with the test cases */
  ARMWRIGHT_STOCHASTIC = 1u << 5,      /* uses its seed */
  ARMWRIGHT_GENERATIONS = 1u << 6,     /* calls begin_generation() before each of its generations */
  ARMWRIGHT_LOCAL = 1u << 7,           /* descends from the start and ends by itself */
  ARMWRIGHT_PACED = 1u << 8,           /* divides the budget up beforehand */
  ARMWRIGHT_RESIDUALS = 1u << 9,       /* since 2.0: uses residuals, so that evaluations have them */
  ARMWRIGHT_SAMPLING = 1u << 10,       /* since 2.0: does not learn from evaluations */
  ARMWRIGHT_INTEGERS = 1u << 11,       /* since 2.0: asks for whole numbers for integer variables.
                                          Without it they look real, and points are rounded */
  ARMWRIGHT_CATEGORIES = 1u << 12      /* since 2.0: treats the words of a category as words without
                                          an order. Without it they look like integers */
};

/* Types of variables, since 2.0. A plugin without ARMWRIGHT_INTEGERS and ARMWRIGHT_CATEGORIES sees
 * real variables only. */
enum {
  ARMWRIGHT_REAL_VARIABLE = 0,
  ARMWRIGHT_INTEGER_VARIABLE = 1, /* whole numbers, bounds and start included */
  ARMWRIGHT_CATEGORY_VARIABLE = 2 /* the number of a word, from 0 */
};

/* How an evaluation went. Objectives are finite always: a failed one shows the problem's penalty.
 */
enum {
  ARMWRIGHT_OK = 0,
  ARMWRIGHT_DIVERGED = 1,    /* a simulation diverged */
  ARMWRIGHT_UNREACHABLE = 2, /* a target lies out of reach */
  ARMWRIGHT_TIMED_OUT = 3,
  ARMWRIGHT_FAILED = 4,
  ARMWRIGHT_ABANDONED = 5 /* lost a race: the objective is of some cases only, or a bound */
};

/* The problem: minimise the objectives over a box. Arrays of decision variables have `dimension`
 * elements. A constraint g is met where g <= 0. */
struct armwright_problem {
  size_t struct_size;
  const char* name;
  size_t dimension;
  const char* const* variable_names;
  const char* const* variable_units;
  const double* lower;
  const double* upper;
  const double* start; /* inside the box; a good method evaluates it first */
  /* 1: a factor means the same everywhere in the range (bounds of one sign, not zero): search its
   * logarithm. 0: linear. */
  const uint8_t* is_logarithmic;
  size_t objective_count; /* at least 1 */
  const char* const* objective_names;
  size_t constraint_count;
  const char* const* constraint_names;

  /* Since 2.0. */
  const char* const* objective_units;
  const char* const* constraint_units;
  /* One weight per objective: the run is judged by the weighted sum of the objectives. NULL: it is
   * judged by the first objective. armwright_scalar() computes the number. */
  const double* objective_weights;
  /* 1: evaluations have residuals. The sum of their squares is the objective, or its exponential. */
  size_t has_residuals;
  const uint8_t* variable_types;
  /* The words of each category, `upper` + 1 of them. NULL for other variables. */
  const char* const* const* variable_choices;
};

/* Returns the number by which the run is judged: the weighted sum of the objectives or, without
 * weights, the first objective. Since 2.0. */
static inline double armwright_scalar(const struct armwright_problem* problem,
                                      const double* objectives) {
  size_t i;
  double sum = 0;
  if (problem->struct_size <= offsetof(struct armwright_problem, objective_weights) ||
      problem->objective_weights == NULL) {
    return objectives[0];
  }
  for (i = 0; i < problem->objective_count; ++i) {
    sum += problem->objective_weights[i] * objectives[i];
  }
  return sum;
}

/* The only door to the problem. Pass `context` to every function. The functions may be called from
 * one thread at a time. Who calls them 100 000 times in a row without a point to evaluate has lost
 * its way: the run ends with a failure. */
struct armwright_evaluator {
  size_t struct_size;
  void* context;

  /* Evaluates `count` points, each `dimension` finite numbers, one after the other in `points`.
   * `objectives` gets count * objective_count numbers, `constraint_values` count * constraint_count
   * (NaN where the evaluation failed: take it as violated beyond measure), `statuses` count
   * numbers; each of the three may be NULL. Returns how many points were evaluated, the first ones:
   * fewer than asked for when the budget, the time or the user's patience ends. Return from
   * minimize() then. */
  size_t (*evaluate)(void* context, const double* points, size_t count, double* objectives,
                     double* constraint_values, int32_t* statuses);

  /* 1 when there is nothing more to come. */
  int (*stopped)(void* context);

  /* How many more points the budget allows. */
  int64_t (*remaining)(void* context);

  /* Optimizers with generations (ARMWRIGHT_GENERATIONS) call it before each, the first included. */
  void (*begin_generation)(void* context);

  /* A point worth judging at the end beside the best ones evaluated: a distribution's mean, say. It
   * counts also when the budget has ended, for one second and for up to 100 points. */
  void (*recommend)(void* context, const double* point);

  /* Since 2.0. Both are about point number `point`, from 0, of the latest evaluate(). */

  /* Returns the residuals of the point, valid until the next evaluate(), and sets *count to their
   * number. NULL and 0 where the evaluation failed or was abandoned, where the problem has no
   * residuals, and without the capability ARMWRIGHT_RESIDUALS. */
  const double* (*residuals)(void* context, size_t point, size_t* count);

  /* Returns 1 if the point was outside the bounds and was evaluated at the nearest point inside. */
  int (*is_clipped)(void* context, size_t point);
};

/* Types of options. */
enum { ARMWRIGHT_BOOL = 0, ARMWRIGHT_INTEGER = 1, ARMWRIGHT_NUMBER = 2, ARMWRIGHT_TEXT = 3 };

/* One option, given by the user as --opt NAME=VALUE. armwright checks type and range before
 * minimize() is called. Names are lower-case letters, digits and underscores. */
struct armwright_option {
  const char* name;
  const char* description; /* one line */
  int32_t type;
  double fallback;            /* the default: 0 or 1 for ARMWRIGHT_BOOL; unused for texts */
  double lower;               /* numbers: the closed range allowed */
  double upper;               /* integers and their range: up to 2^53 in magnitude */
  const char* fallback_text;  /* texts: the default; otherwise NULL */
  const char* const* choices; /* texts: what is allowed, ended by NULL; or NULL: anything */
};

/* The options' values: every declared option has one. Asking for an option that was not declared,
 * or as another type, ends the run with a message. The text lives as long as minimize() runs. */
struct armwright_options {
  size_t struct_size;
  void* context;
  int (*get_bool)(void* context, const char* name);
  int64_t (*get_integer)(void* context, const char* name);
  double (*get_number)(void* context, const char* name);
  const char* (*get_text)(void* context, const char* name);
};

/* The optimizer. What armwright_plugin() returns must stay as it is while the library is open. */
struct armwright_plugin {
  uint32_t abi;        /* ARMWRIGHT_PLUGIN_ABI */
  size_t struct_size;  /* sizeof(struct armwright_plugin) */
  const char* name;    /* short: letters, digits, "-", "_", ":" */
  const char* summary; /* one line */
  const char* source;  /* author, year, title; or who wrote it */
  uint32_t capabilities;
  const struct armwright_option* options; /* or NULL */
  size_t option_count;

  /* Returns 0 when the evaluator has stopped or there is nothing more to try; a text that it leaves
   * in `message` then says why it ended. On a failure it returns anything else and leaves the reason
   * in `message`, which has room for `message_size` bytes, the zero byte included. The same seed
   * must give the same points, whatever else happens. */
  int (*minimize)(const struct armwright_problem* problem,
                  const struct armwright_evaluator* evaluator,
                  const struct armwright_options* options, uint64_t seed, char* message,
                  size_t message_size);

  /* Since 2.0: the least that a problem must have. 0 asks for nothing. */
  size_t least_objectives;
  size_t least_variables;
  size_t needs_residuals; /* 1: residuals */
};

/* What every plugin defines:
 *
 *     ARMWRIGHT_PLUGIN_EXPORT const struct armwright_plugin* armwright_plugin(void) {
 *       return &mine;
 *     }
 */
#define ARMWRIGHT_PLUGIN_SYMBOL "armwright_plugin"
#if defined(__cplusplus) && defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow" /* the function is named like the struct, on purpose */
#endif
ARMWRIGHT_PLUGIN_EXPORT const struct armwright_plugin* armwright_plugin(void);
#if defined(__cplusplus) && defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#ifdef __cplusplus
}
#endif

#endif
