// Describes itself in the wrong way that the environment's ARMWRIGHT_TEST_PLUGIN names.
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "armwright/plugin.h"

namespace {

int minimize(const armwright_problem*, const armwright_evaluator*, const armwright_options*,
             std::uint64_t, char*, std::size_t) {
  return 0;
}

armwright_option options[] = {
    {"rate", "", ARMWRIGHT_NUMBER, 0.5, 0, 1, nullptr, nullptr},
    {"kind", "", ARMWRIGHT_TEXT, 0, 0, 0, "one", nullptr},
};
struct armwright_plugin plugin = {ARMWRIGHT_PLUGIN_ABI,
                                  sizeof(struct armwright_plugin),
                                  "x",
                                  "",
                                  "",
                                  0,
                                  options,
                                  2,
                                  minimize,
                                  1,
                                  1,
                                  0};

}  // namespace

extern "C" const struct armwright_plugin* armwright_plugin(void) {
  static const char* const other_choices[] = {"two", nullptr};
  const char* const given = std::getenv("ARMWRIGHT_TEST_PLUGIN");
  const auto is = [given](const char* name) {
    return given != nullptr && std::strcmp(given, name) == 0;
  };
  if (is("null")) {
    return nullptr;
  } else if (is("crash")) {
    std::raise(SIGSEGV);
  } else if (is("hang")) {
    const volatile bool is_true = true;
    while (is_true) {
    }
  } else if (is("exit")) {
    std::exit(0);
  } else if (is("abi")) {
    plugin.abi = 99;
  } else if (is("size")) {
    plugin.struct_size = 8;
  } else if (is("no_name")) {
    plugin.name = nullptr;
  } else if (is("bad_name")) {
    plugin.name = "two words";
  } else if (is("no_minimize")) {
    plugin.minimize = nullptr;
  } else if (is("capabilities")) {
    plugin.capabilities = 1u << 31;
  } else if (is("no_options")) {
    plugin.options = nullptr;
  } else if (is("twice")) {
    options[1].name = "rate";
  } else if (is("ours")) {
    options[0].name = "silence_s";
  } else if (is("range")) {
    options[0].fallback = 2;
  } else if (is("type")) {
    options[0].type = 12;
  } else if (is("integer")) {
    options[0].type = ARMWRIGHT_INTEGER;
  } else if (is("choice")) {
    options[1].choices = other_choices;
  }
  return &plugin;
}
