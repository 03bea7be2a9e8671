/* armwright as a library of your own program, in C99: runs any optimizer on a problem that the
 * program computes itself (problem.h), with journal, resume and result files. run.hpp wraps it for
 * C++. Link with libarmwright: find_package(armwright COMPONENTS run), target armwright::armwright.
 *
 * The run takes place in the calling process. armwright starts `jobs` threads that call the
 * problem's functions, all at the same time if jobs > 1. It installs no signal handler. A crash of
 * the problem ends the program; the next run in the same folder continues from the journal.
 *
 * Structs begin with their sizes. Later versions of armwright may append fields; they never change
 * or remove any without a new major version of the library. A field that is zero or NULL stands for
 * its default. Texts are UTF-8 and end with a zero byte.
 */
#ifndef ARMWRIGHT_RUN_H
#define ARMWRIGHT_RUN_H

#include <stddef.h>
#include <stdint.h>

#include "armwright/problem.h"

#ifdef __cplusplus
extern "C" {
#endif

#if defined(_WIN32)
#define ARMWRIGHT_RUN_API
#else
#define ARMWRIGHT_RUN_API __attribute__((visibility("default")))
#endif

/* armwright_run() returns 0, or the exit code that the command line has for such an error. */
enum {
  ARMWRIGHT_RUN_OK = 0,
  ARMWRIGHT_RUN_INTERNAL = 1, /* memory, or a bug of armwright */
  ARMWRIGHT_RUN_USAGE = 2,    /* a wrong name, option or number, or another run in the folder */
  ARMWRIGHT_RUN_BAD_DATA = 4, /* a damaged journal, or a problem that breaks its contract */
  ARMWRIGHT_RUN_BUSY = 5,     /* another process writes the folder */
  ARMWRIGHT_RUN_IO = 74       /* the system refused to read or write */
};

struct armwright_run_progress {
  size_t struct_size;
  const char* phase; /* "training", "validation" or "test" */
  uint64_t done;     /* cases of the phase, of `total` */
  uint64_t total;
  double best; /* the best objective so far; NaN before the first one */
};

struct armwright_run_request {
  size_t struct_size;
  const struct armwright_user_problem* problem; /* valid until armwright_run() returns */
  const char* optimizer;                        /* as for `armwright optimize`; NULL: "ga" */
  const char* const* options;                   /* of the optimizer: "sigma=0.2" */
  size_t option_count;
  const char* const* settings; /* of the problem, as --set has them: "sets.test_cases=50" */
  size_t setting_count;
  uint64_t seed;        /* 0 is an ordinary seed */
  int64_t budget;       /* training cases; 0: 10000 */
  const char* schedule; /* "fixed:5"; NULL: one fixed case */
  const char* racing;   /* "halving:4:2"; NULL: none */
  const char* folder;   /* NULL: results/PROBLEM-OPTIMIZER-seedN and what was set. A run in it is resumed */
  uint32_t jobs;        /* threads; 0: 1 */
  double time_limit_s;  /* 0: none. The run ends early then, and the same call resumes it */

  void* context; /* armwright passes it to the functions below. Each may be NULL. */
  /* Returns 1 if the run must end early. Any thread calls it, and often. */
  int (*must_stop)(void* context);
  /* Any thread calls the next two, one call at a time. */
  void (*on_progress)(void* context, const struct armwright_run_progress* progress);
  void (*on_message)(void* context, const char* message);
};

/* The result. Its arrays belong to it. The numbers of the winner are those on the test cases, as
 * the problem gave them: objectives in their own direction. */
struct armwright_run_result {
  size_t struct_size;
  const char* folder;
  int32_t is_finished; /* 0: ended early; only `folder` is set, and the same call resumes the run */
  int32_t has_winner;  /* 0: no evaluation had an objective */
  int32_t is_feasible; /* 1: the winner meets every constraint on every test case */
  const char* end_reason; /* "budget", "optimizer finished" or "optimizer failed" */
  const char* failure;    /* how the optimizer failed; empty if it did not */
  uint64_t evaluations;
  uint64_t failed_evaluations;
  size_t variable_count;
  const double* x;
  size_t objective_count;
  const double* objectives;
  size_t constraint_count;
  const double* constraints; /* met if <= the constraint's limit or, without a limit, <= 0 */
};

/* Runs an optimizer, or resumes the run in the folder, or returns the result of a run that has
 * ended. The result is the same for any number of threads and interruptions. Returns 0 and a result
 * that armwright_free_result() frees, or one of the codes above and the reason in `message`, which
 * has room for `message_size` bytes. */
ARMWRIGHT_RUN_API int armwright_run(const struct armwright_run_request* request,
                                    const struct armwright_run_result** result, char* message,
                                    size_t message_size);

ARMWRIGHT_RUN_API void armwright_free_result(const struct armwright_run_result* result);

/* Returns the version of the library: "2.0.0". */
ARMWRIGHT_RUN_API const char* armwright_version(void);

#ifdef __cplusplus
}
#endif

#endif
