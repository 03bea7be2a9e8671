/* An optimization problem for armwright as a shared library, in C99 or anything that can call and
 * be called like it. This header stands alone; problem.hpp wraps it for C++.
 *
 * A library exports one function, armwright_user_problem(), which returns a description of the
 * problem and the functions that compute it. armwright opens the library in processes of its own,
 * one per simulating thread, so a crash costs one case and not the run.
 *
 *     armwright optimize ./libmine.so --optimizer cmaes
 *
 * A program that calls armwright as a library (run.h) passes the same struct.
 *
 * Everything that crosses the border is a plain struct. Structs that armwright makes, and
 * armwright_user_problem, begin with their sizes or have them behind `abi`: later versions of
 * armwright may append fields to them. They never change or remove any without a new
 * ARMWRIGHT_PROBLEM_ABI. Texts are UTF-8 and end with a zero byte. No pointer that armwright hands
 * over is valid after the call.
 */
#ifndef ARMWRIGHT_PROBLEM_H
#define ARMWRIGHT_PROBLEM_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The version of what this header describes. armwright refuses problems of another one. */
#define ARMWRIGHT_PROBLEM_ABI 1u

/* Marks the one function that a library exports, also where everything else is hidden. */
#if defined(_WIN32)
#define ARMWRIGHT_PROBLEM_EXPORT __declspec(dllexport)
#else
#define ARMWRIGHT_PROBLEM_EXPORT __attribute__((visibility("default")))
#endif

/* The types of variables. */
enum {
  ARMWRIGHT_VARIABLE_REAL = 0,
  ARMWRIGHT_VARIABLE_INTEGER = 1, /* whole numbers, as doubles */
  ARMWRIGHT_VARIABLE_CATEGORY = 2 /* one of several words; its value is the word's place, from 0 */
};

/* One variable of the decision vector. A field that is zero or NULL has no effect, except for
 * bounds and start. */
struct armwright_variable {
  const char* name;
  const char* unit; /* or NULL */
  int32_t type;     /* ARMWRIGHT_VARIABLE_... */
  double lower;     /* not for categories */
  double upper;
  double start;               /* NAN: the middle of the bounds. Of a category: a word's place */
  int32_t is_logarithmic;     /* 1: bounds of one sign, not zero, searched by their logarithm */
  const char* const* choices; /* the words of a category, ended by NULL */
};

/* A number that is minimised or maximised. */
struct armwright_objective {
  const char* name;
  const char* unit;
  int32_t is_maximised;
  double weight;         /* > 0, of the weighted sum where one number is needed; 0 stands for 1 */
  const double* penalty; /* what a failed training case counts as; NULL: a candidate with a failed
                            case has no objectives. For all objectives or for none */
  const double* bound;   /* no case has a better value; NULL: not known */
};

/* A number that is limited. It is met if it is <= limit or, without a limit, <= 0. */
struct armwright_constraint {
  const char* name;
  const char* unit;
  double limit; /* > 0; 0: without a limit */
};

/* A further number, which reports show. */
struct armwright_metric {
  const char* name;
  const char* unit;
};

/* One question: a decision vector on one case. */
struct armwright_case {
  size_t struct_size;
  const double* x; /* one number per variable, within the bounds and of the variable's type */
  uint64_t number; /* of the case within its set, from 0 */
  uint64_t seed;   /* for random numbers of the case; at most 2^53 - 1, the same for every x */
  const char* set; /* the name of the case's set: "train/1" */
  int32_t role;    /* 0: training, 1: validation, 2: test */
  int32_t wants_residuals;
};

/* How a case went. */
enum {
  ARMWRIGHT_CASE_OK = 0,
  ARMWRIGHT_CASE_DIVERGED = 1,
  ARMWRIGHT_CASE_UNREACHABLE = 2,
  ARMWRIGHT_CASE_FAILED = 4,
  /* No case can be computed, for example because a file is missing: the run ends with the reason.
   */
  ARMWRIGHT_CASE_BROKEN = 100
};

/* The answer to one question. armwright owns the arrays. A number that is left NaN, or is infinite,
 * makes the case a failed one. */
struct armwright_answer {
  size_t struct_size;
  void* context;       /* of armwright */
  int32_t status;      /* ARMWRIGHT_CASE_OK at first; of others, the numbers do not count */
  double* objectives;  /* one per objective, NaN at first; so are the next two */
  double* constraints; /* one per constraint */
  double* metrics;     /* one per metric */
  char* reason;        /* why the status is not ARMWRIGHT_CASE_OK */
  size_t reason_size;  /* bytes, the zero byte included */
  /* Copies the residuals of the case. Their squares add up to the objective. */
  void (*set_residuals)(struct armwright_answer* answer, const double* values, size_t count);
};

/* The signals and files of one case. Reports show them for the winner. The functions copy. */
struct armwright_record {
  size_t struct_size;
  void* context; /* of armwright */
  /* Sets the abscissa of all signals: "time", "s". Call it before add_series(). */
  void (*set_abscissa)(struct armwright_record* record, const char* name, const char* unit,
                       const double* values, size_t count);
  /* A signal with as many values as the abscissa. */
  void (*add_series)(struct armwright_record* record, const char* name, const char* unit,
                     const double* values, size_t count);
  /* A file, for example a picture: "step.png". */
  void (*add_file)(struct armwright_record* record, const char* name, const void* bytes,
                   size_t size);
};

/* For a number of cases: as many as armwright asks for, because a case is made from its number. */
#define ARMWRIGHT_ANY_CASES (-1)

/* The problem. What armwright_user_problem() returns must stay as it is while the library is open.
 */
struct armwright_user_problem {
  uint32_t abi;        /* ARMWRIGHT_PROBLEM_ABI */
  size_t struct_size;  /* sizeof(struct armwright_user_problem) */
  const char* name;    /* folders are named after it */
  const char* summary; /* one line */
  const struct armwright_variable* variables;
  size_t variable_count;
  const struct armwright_objective* objectives;
  size_t objective_count;
  const struct armwright_constraint* constraints; /* or NULL */
  size_t constraint_count;
  const struct armwright_metric* metrics; /* or NULL */
  size_t metric_count;
  int32_t has_residuals;    /* 1: the objective is the sum of the squares of the residuals */
  int32_t takes_worst_case; /* how objectives of several cases combine. 0: mean; 1: worst value */
  int32_t is_noisy;         /* 1: the same question may have different answers */
  /* How many cases each set has; 0 stands for 1. Training may have ARMWRIGHT_ANY_CASES. */
  int64_t training_cases;
  int64_t validation_cases;
  int64_t test_cases;

  void* context; /* armwright passes it to the functions below */

  /* Answers one question. The answer depends on the question alone, unless is_noisy. In a library
   * one thread calls. In a program of your own, `jobs` threads call at the same time. */
  void (*evaluate)(void* context, const struct armwright_case* question,
                   struct armwright_answer* answer);
  /* Answers `count` questions of one set, at most 1000. NULL: armwright calls evaluate(). */
  void (*evaluate_batch)(void* context, const struct armwright_case* const* questions,
                         struct armwright_answer* const* answers, size_t count);
  /* Computes a case again and records it. NULL: there is nothing to record. Returns 0, or another
   * number with the reason in `message`. */
  int (*record)(void* context, const struct armwright_case* question,
                struct armwright_record* record, char* message, size_t message_size);
};

/* Every library of a problem defines this function:
 *
 *     ARMWRIGHT_PROBLEM_EXPORT const struct armwright_user_problem* armwright_user_problem(void) {
 *       return &mine;
 *     }
 */
#define ARMWRIGHT_PROBLEM_SYMBOL "armwright_user_problem"
#if defined(__cplusplus) && defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow" /* the function is named like the struct, on purpose */
#endif
ARMWRIGHT_PROBLEM_EXPORT const struct armwright_user_problem* armwright_user_problem(void);
#if defined(__cplusplus) && defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#ifdef __cplusplus
}
#endif

#endif
