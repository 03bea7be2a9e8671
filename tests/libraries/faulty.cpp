// A problem with one variable, whose number from 0 to 20 chooses a fault. Other faults are those of
// the description, which the environment variable FAULT chooses.
#include <signal.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "armwright/problem.hpp"

namespace {

using namespace armwright::problem;

class Faulty : public Problem {
 public:
  Description describe() const override {
    const char* const variable = std::getenv("FAULT");
    const std::string fault = variable == nullptr ? "" : variable;
    if (fault == "crash") {
      std::puts("about to crash");
      std::fflush(stdout);
      raise(SIGSEGV);
    } else if (fault == "exit") {
      std::exit(3);
    } else if (fault == "exception") {
      throw std::runtime_error("no licence");
    }
    Description all;
    all.name = "faulty";
    all.variables = {integer("fault", "", 0, 20)};
    all.objectives = {{"f"}};
    if (fault == "bounds") {
      all.variables[0].lower = 30;
    } else if (fault == "start") {
      all.variables[0].start = 21;
    } else if (fault == "twice") {
      all.variables.push_back(all.variables[0]);
    } else if (fault == "infinite") {
      all.variables[0].upper = std::numeric_limits<double>::infinity();
    } else if (fault == "type") {
      all.variables[0].type = 7;
    } else if (fault == "nameless") {
      all.objectives[0].name = "";
    } else if (fault == "word") {
      all.variables = {category("kind", {"a", "b"})};
      all.variables[0].start = 2;
    } else if (fault == "other") {
      all.variables[0].upper = 19;
    }
    return all;
  }

  Answer evaluate(const Point& x, const Case& /*one*/) override {
    Answer answer(x[0]);
    switch (static_cast<int>(x[0])) {
      case 1:
        raise(SIGSEGV);
        break;
      case 2:
        std::exit(7);
      case 3:
        for (volatile bool is_endless = true; is_endless;) {
        }
        break;
      case 4:
        throw std::runtime_error("it broke");
      case 5:
        throw 5;
      case 6:
        answer.objectives.push_back(1);
        break;
      case 7:
        return std::nan("");
      case 8:
        return std::numeric_limits<double>::infinity();
      case 9:
        for (std::size_t mib = 1; mib < 4096; ++mib) {
          auto* const block = static_cast<volatile char*>(std::malloc(std::size_t{1} << 20));
          if (block == nullptr) {
            throw std::bad_alloc();
          }
          block[0] = 1;
        }
        break;
      case 10:
        std::printf("%s", std::string(1 << 22, 'x').c_str());
        std::fprintf(stderr, "to the error stream\n");
        break;
      case 11:
        fork();  // the child returns, too
        break;
      case 12:
        if (fork() == 0) {
          pause();
        }
        break;
      case 13:
        throw Broken("the file of measurements is missing");
      case 14:
        return Answer::failed("no solution");
      case 15:
        return Answer::failed("odd", 17);
      case 16:
        static_cast<void>(write(3, "nonsense in the connection", 26));
        break;
      case 17:
        close(3);
        break;
      case 18:
        return Answer::failed("", ARMWRIGHT_CASE_DIVERGED);
      default:
        break;
    }
    return answer;
  }
};

}  // namespace

ARMWRIGHT_PROBLEM(Faulty)
