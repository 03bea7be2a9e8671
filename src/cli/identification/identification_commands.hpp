// The subcommands that find a robot's plant in logs and motions worth recording, as those of cli/commands/commands.hpp.
#pragma once

namespace CLI {
class App;
}

namespace armwright {

struct Session;

void add_identify(CLI::App& app, Session& session);
void add_excite(CLI::App& app, Session& session);

}  // namespace armwright
