// Starts the program.

#include "cli/app.hpp"

int main(int argc, char** argv) {
  return armwright::run_app(argc, argv);
}
