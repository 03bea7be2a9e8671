// The program: builds the parser, runs the chosen subcommand and turns every error into an exit
// code.
#pragma once

namespace CLI {
class App;
}

namespace armwright {

struct Session;

// Adds the program's name, its help and all subcommands to the parser.
void add_all_commands(CLI::App& app, Session& session);

// Runs one call of the program and returns its exit code. Throws nothing: it prints every error on
// stderr.
int run_app(int argc, char** argv);

}  // namespace armwright
