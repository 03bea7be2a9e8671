// Tunes the speed control of a motor with armwright as a library, in this process:
// ./own_program [FOLDER [OPTIMIZER [THREADS]]]. Start it again after Ctrl-C to resume it.
#include <armwright/run.hpp>
#include <cstdlib>
#include <iostream>

#include "speed_control.hpp"

int main(int argc, char** argv) try {
  SpeedControl problem;
  const auto outcome = armwright::optimize(
      problem, {.optimizer = argc > 2 ? argv[2] : "cmaes",
                .budget = 2000,
                .folder = argc > 1 ? argv[1] : "results/speed-control",
                .jobs = argc > 3 ? static_cast<unsigned>(std::atoi(argv[3])) : 1,
                .on_message = [](const std::string& message) { std::cerr << message << '\n'; }});
  std::cout << outcome.folder << ": " << outcome.end_reason << "; kp, ki and filter:";
  for (const double value : outcome.x) {
    std::cout << ' ' << value;
  }
  std::cout << '\n';
} catch (const armwright::run::RunError& error) {
  std::cerr << "error: " << error.what() << '\n';
  return error.code();
}
