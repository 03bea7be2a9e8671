// Does what its option `how` says, after two evaluations; straight on the C border. It promises to
// keep to the bounds.
#include <sys/types.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "armwright/plugin.h"

namespace {

int minimize(const armwright_problem* problem, const armwright_evaluator* evaluator,
             const armwright_options* options, std::uint64_t /*seed*/, char* message,
             std::size_t message_size) {
  const auto evaluate = [&](const std::vector<double>& x) {
    evaluator->evaluate(evaluator->context, x.data(), 1, nullptr, nullptr, nullptr);
  };
  std::vector<double> x(problem->start, problem->start + problem->dimension);
  evaluate(x);
  evaluate(x);
  const std::string how = options->get_text(options->context, "how");
  std::puts("two points are evaluated");
  if (how == "throw") {
    throw std::runtime_error("out of ideas");
  }
  if (how == "fail") {
    std::strncpy(message, "the matrix is singular", message_size);
    return 7;
  }
  if (how == "exit") {
    std::exit(3);
  }
  if (how == "segfault") {
    std::raise(SIGSEGV);
  }
  if (how == "loop") {
    const volatile bool is_true = true;
    while (is_true) {
    }
  }
  if (how == "allocate") {
    std::vector<std::vector<char>> hoard;
    while (true) {
      hoard.emplace_back(std::size_t{16} << 20, 'x');
    }
  }
  if (how == "nan") {
    x[0] = std::numeric_limits<double>::quiet_NaN();
    evaluate(x);
  }
  if (how == "outside") {
    x[0] = 2 * problem->upper[0] + 1;
    evaluate(x);
  }
  if (how == "count") {
    evaluator->evaluate(evaluator->context, x.data(), SIZE_MAX / 64, nullptr, nullptr, nullptr);
  }
  if (how == "print") {
    while (true) {
      std::fputs("I have nothing to say and I say it. ", stderr);
    }
  }
  if (how == "children") {
    const pid_t child = fork();
    if (child == 0) {
      while (true) {
        pause();
      }
    }
    std::printf("child %d\n", static_cast<int>(child));
    std::abort();
  }
  if (how == "close") {
    closefrom(0);
    evaluate(x);
  }
  if (how == "garbage") {
    for (int fd = 0; fd < 16; ++fd) {
      [[maybe_unused]] const ssize_t written = write(fd, "\0garbage\xff\xff\xff\xff", 13);
    }
    evaluate(x);
  }
  if (how == "undeclared") {
    options->get_number(options->context, "hwo");
  }
  if (how == "endless") {
    while (true) {
      evaluate(x);
    }
  }
  return 0;
}

const armwright_option kOptions[] = {
    {"how", "what to do wrong", ARMWRIGHT_TEXT, 0, 0, 0, "fail", nullptr}};

const struct armwright_plugin kPlugin = {ARMWRIGHT_PLUGIN_ABI,
                                         sizeof(struct armwright_plugin),
                                         "misbehaving",
                                         "Misbehaves",
                                         "nobody",
                                         ARMWRIGHT_BOUNDS,
                                         kOptions,
                                         1,
                                         minimize,
                                         1,
                                         1,
                                         0};

}  // namespace

extern "C" const struct armwright_plugin* armwright_plugin(void) {
  return &kPlugin;
}
