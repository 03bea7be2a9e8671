// The command line: parses it, runs the chosen subcommand and turns every error into the documented
// exit code.
#pragma once

namespace armwright {

int run_app(int argc, char** argv);

}  // namespace armwright
