#include "optimizers/plugin_library.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "base/text.hpp"
#include "optimizers/child_process.hpp"
#include "optimizers/packet.hpp"
#include "optimizers/plugin_call.hpp"

namespace armwright {
namespace {

constexpr std::size_t kMaxLibraryBytes = std::size_t{1} << 30;
constexpr std::size_t kMaxOptions = 1000;
constexpr std::size_t kMaxChoices = 1000;
constexpr double kMaxInteger = 9007199254740992;  // 2^53: doubles below it tell integers apart
constexpr const char* kOwnOptions[] = {"isolate", "silence_s", "memory_mib"};

// Why a library is no plugin.
class Refusal : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

// In the process that is to call it. The library stays open: what it has started may still run.
const struct armwright_plugin& open_plugin(const std::filesystem::path& file) {
  void* const library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    throw Refusal(fmt::format("is no shared library that can be opened: {}", dlerror()));
  }
  void* const symbol = dlsym(library, ARMWRIGHT_PLUGIN_SYMBOL);
  if (symbol == nullptr) {
    throw Refusal(
        fmt::format("exports no function '{0}'; a plugin defines ARMWRIGHT_PLUGIN_EXPORT const "
                    "struct armwright_plugin* {0}(void), in C++ as extern \"C\" or by the macro "
                    "ARMWRIGHT_PLUGIN of armwright/plugin.hpp",
                    ARMWRIGHT_PLUGIN_SYMBOL));
  }
  const auto* const plugin = reinterpret_cast<decltype(&::armwright_plugin)>(symbol)();
  if (plugin == nullptr) {
    throw Refusal("describes nothing: armwright_plugin() returned NULL");
  }
  if (plugin->abi != ARMWRIGHT_PLUGIN_ABI) {
    throw Refusal(
        fmt::format("is built for version {} of the plugin interface, and this armwright has "
                    "version {}; build it against this armwright's armwright/plugin.h",
                    plugin->abi, ARMWRIGHT_PLUGIN_ABI));
  }
  if (plugin->struct_size < sizeof(struct armwright_plugin)) {
    throw Refusal(
        fmt::format("says that its struct armwright_plugin has {} bytes; it has {} or "
                    "more",
                    plugin->struct_size, sizeof(struct armwright_plugin)));
  }
  return *plugin;
}

std::string take_text(const char* text, const std::string& what) {
  if (text == nullptr) {
    throw Refusal(what + " is NULL");
  }
  const std::string taken = sanitize(text);
  if (taken.size() > 1000) {
    throw Refusal(what + " has more than 1000 bytes");
  }
  return taken;
}

std::string take_name(const char* text, const std::string& what, std::string_view extra) {
  const std::string name = take_text(text, what);
  const auto is_allowed = [extra](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || extra.find(c) != extra.npos;
  };
  if (name.empty() || !std::ranges::all_of(name, is_allowed)) {
    throw Refusal(fmt::format("{} is '{}'; it must be of letters, digits and {}", what, name,
                              extra == "_" ? "underscores, the letters small" : "-, _ and :"));
  }
  return name;
}

OptionSpec take_option(const armwright_option& raw, std::size_t number) {
  OptionSpec option;
  option.name = take_name(raw.name, fmt::format("the name of option {}", number), "_");
  const std::string what = fmt::format("option '{}': ", option.name);
  option.description = take_text(raw.description, what + "its description");
  option.lower = raw.lower;
  option.upper = raw.upper;
  const bool is_number = raw.type == ARMWRIGHT_NUMBER || raw.type == ARMWRIGHT_INTEGER;
  if (is_number && !(std::isfinite(raw.lower) && std::isfinite(raw.upper) &&
                     raw.lower <= raw.fallback && raw.fallback <= raw.upper)) {
    throw Refusal(
        fmt::format("{}its default is {}, its range from {} to {}; the range must be "
                    "finite and hold the default",
                    what, raw.fallback, raw.lower, raw.upper));
  }
  switch (raw.type) {
    case ARMWRIGHT_BOOL:
      if (raw.fallback != 0 && raw.fallback != 1) {
        throw Refusal(fmt::format("{}its default is {}; it must be 0 or 1", what, raw.fallback));
      }
      option.fallback = raw.fallback == 1;
      break;
    case ARMWRIGHT_INTEGER:
      for (const double value : {raw.fallback, raw.lower, raw.upper}) {
        if (value != std::floor(value) || std::abs(value) > kMaxInteger) {
          throw Refusal(fmt::format("{}{} is no integer up to 2^53", what, value));
        }
      }
      option.fallback = static_cast<std::int64_t>(raw.fallback);
      break;
    case ARMWRIGHT_NUMBER:
      option.fallback = raw.fallback;
      break;
    case ARMWRIGHT_TEXT: {
      const std::string fallback = take_text(raw.fallback_text, what + "its default");
      for (std::size_t i = 0; raw.choices != nullptr && raw.choices[i] != nullptr; ++i) {
        if (i == kMaxChoices) {
          throw Refusal(what + "its choices do not end with NULL");
        }
        option.choices.push_back(take_text(raw.choices[i], what + "a choice"));
      }
      if (!option.choices.empty() && std::ranges::count(option.choices, fallback) == 0) {
        throw Refusal(fmt::format("{}its default '{}' is not among its choices: {}", what, fallback,
                                  join(option.choices, ", ")));
      }
      option.fallback = fallback;
      break;
    }
    default:
      throw Refusal(fmt::format("{}its type is {}; there are 0 to 3", what, raw.type));
  }
  return option;
}

struct Description {
  std::string name;
  std::string summary;
  std::string source;
  std::uint32_t capabilities = 0;
  std::vector<OptionSpec> options;
};

Description take_description(const struct armwright_plugin& plugin) {
  constexpr std::uint32_t kKnown = (ARMWRIGHT_PACED << 1) - 1;
  Description taken;
  taken.name = take_name(plugin.name, "its name", "_-:ABCDEFGHIJKLMNOPQRSTUVWXYZ");
  taken.summary = take_text(plugin.summary, "its summary");
  taken.source = take_text(plugin.source, "its source");
  taken.capabilities = plugin.capabilities;
  if ((plugin.capabilities & ~kKnown) != 0) {
    throw Refusal(
        fmt::format("declares capabilities that this armwright does not know (bits {:#x})",
                    plugin.capabilities & ~kKnown));
  }
  if (plugin.minimize == nullptr) {
    throw Refusal("has no function minimize: it is NULL");
  }
  if (plugin.option_count > kMaxOptions || (plugin.option_count > 0 && plugin.options == nullptr)) {
    throw Refusal(fmt::format("says that it has {} options{}", plugin.option_count,
                              plugin.options == nullptr ? ", and points to none" : ""));
  }
  for (std::size_t i = 0; i < plugin.option_count; ++i) {
    OptionSpec option = take_option(plugin.options[i], i + 1);
    const bool is_taken = std::ranges::count(taken.options, option.name, &OptionSpec::name) > 0 ||
                          std::ranges::count(kOwnOptions, option.name) > 0;
    if (is_taken) {
      throw Refusal(fmt::format("declares option '{}', which there is already; every plugin has {}",
                                option.name, fmt::join(kOwnOptions, ", ")));
    }
    taken.options.push_back(std::move(option));
  }
  return taken;
}

std::string pack(const Description& description) {
  PacketWriter writer;
  writer.put(true);
  writer.put(description.summary);
  writer.put(description.source);
  writer.put(description.capabilities);
  writer.put(std::uint64_t{description.options.size()});
  for (const OptionSpec& option : description.options) {
    writer.put(option.name);
    writer.put(option.description);
    writer.put(std::uint64_t{option.fallback.index()});
    std::visit([&writer](const auto& value) { writer.put(value); }, option.fallback);
    writer.put(option.lower);
    writer.put(option.upper);
    writer.put(std::uint64_t{option.choices.size()});
    for (const std::string& choice : option.choices) {
      writer.put(choice);
    }
  }
  return writer.bytes();
}

OptionValue unpack_value(PacketReader& reader) {
  switch (reader.get<std::uint64_t>()) {
    case 0:
      return reader.get<bool>();
    case 1:
      return reader.get<std::int64_t>();
    case 2:
      return reader.get<double>();
    default:
      return reader.get_text();
  }
}

Description unpack(PacketReader& reader) {
  Description description;
  description.summary = reader.get_text();
  description.source = reader.get_text();
  description.capabilities = reader.get<std::uint32_t>();
  for (auto left = reader.get<std::uint64_t>(); left > 0; --left) {
    OptionSpec& option = description.options.emplace_back();
    option.name = reader.get_text();
    option.description = reader.get_text();
    option.fallback = unpack_value(reader);
    option.lower = reader.get<double>();
    option.upper = reader.get<double>();
    for (auto choices = reader.get<std::uint64_t>(); choices > 0; --choices) {
      option.choices.push_back(reader.get_text());
    }
  }
  return description;
}

// Opens the library in a child, which sends (true, description) or (false, why not).
Description describe(const std::filesystem::path& file, const IsolationLimits& limits) {
  std::string message;
  try {
    ChildProcess child(
        [&](ParentLink& parent) {
          try {
            parent.send(pack(take_description(open_plugin(file))));
          } catch (const Refusal& refusal) {
            PacketWriter writer;
            writer.put(false);
            writer.put(std::string_view(refusal.what()));
            parent.send(writer.bytes());
          }
        },
        limits);
    if (child.receive([] { return false; }, message) != ChildProcess::Event::message) {
      throw Refusal("said nothing");
    }
    PacketReader reader(message);
    if (!reader.get<bool>()) {
      throw Refusal(sanitize(reader.get_text()));
    }
    return unpack(reader);
  } catch (const ChildFailure& failure) {
    throw Refusal(fmt::format("cannot be used: while it was opened, it {}", failure.what()));
  } catch (const PacketError&) {
    throw Refusal("cannot be used: while it was opened, it sent what makes no sense");
  }
}

// Holds a plugin to what it has declared, whatever process it runs in.
class StrictEvaluator : public Evaluator {
 public:
  StrictEvaluator(const std::string& name, bool keeps_bounds, Evaluator& evaluator)
      : name_(name), keeps_bounds_(keeps_bounds), evaluator_(evaluator) {}

  const ProblemDescription& problem() const override { return evaluator_.problem(); }
  std::vector<Score> evaluate(std::span<const std::vector<double>> points) override {
    for (std::size_t i = 0; i < points.size(); ++i) {
      check(points[i], [&] { return fmt::format("asked in evaluation {}", evaluations_ + i + 1); });
    }
    std::vector<Score> scores = evaluator_.evaluate(points);
    evaluations_ += scores.size();
    return scores;
  }
  bool stopped() const override { return evaluator_.stopped(); }
  std::int64_t remaining() const override { return evaluator_.remaining(); }
  void begin_generation() override { evaluator_.begin_generation(); }
  void recommend(std::span<const double> x) override {
    check(x, [] { return "asked, recommending a point,"; });
    evaluator_.recommend(x);
  }

 private:
  // `describe_doing` says at what it was caught.
  void check(std::span<const double> x, const auto& describe_doing) const {
    const std::vector<DecisionVariable>& variables = problem().variables;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const auto fail = [&](const std::string& what) {
        throw OptimizerFailure(fmt::format("optimizer '{}' {} for {} = {}, {}", sanitize(name_),
                                           describe_doing(), variables[i].name, format_exact(x[i]),
                                           what));
      };
      if (!std::isfinite(x[i])) {
        fail("which is not a finite number");
      }
      if (keeps_bounds_ && !(variables[i].lower <= x[i] && x[i] <= variables[i].upper)) {
        fail(
            fmt::format("outside of {} to {}, though it declares that it keeps to the bounds "
                        "(ARMWRIGHT_BOUNDS)",
                        format_exact(variables[i].lower), format_exact(variables[i].upper)));
      }
    }
  }

  const std::string& name_;
  bool keeps_bounds_;
  Evaluator& evaluator_;
  std::size_t evaluations_ = 0;
};

std::string calc_file_hash(const std::filesystem::path& file) {
  return calc_sha256_hex(read_file(file, kMaxLibraryBytes));
}

struct Library {
  std::string name;
  std::filesystem::path file;  // absolute: dlopen looks elsewhere for a name without a slash
  std::string hash;
  bool keeps_bounds = false;
};

class LibraryOptimizer : public Optimizer {
 public:
  LibraryOptimizer(Library library, const Options& options)
      : library_(std::move(library)), options_(options) {}

  void minimize(Evaluator& evaluator, std::uint64_t seed) override {
    if (calc_file_hash(library_.file) != library_.hash) {
      fail("is no longer the file that it was when this program started");
    }
    StrictEvaluator strict(library_.name, library_.keeps_bounds, evaluator);
    const auto call = [&](Evaluator& any) {
      try {
        call_plugin(open_plugin(library_.file), options_, any, seed);
      } catch (const Refusal& refusal) {
        throw ChildFailure(refusal.what());
      }
    };
    if (options_.get_bool("isolate")) {
      minimize_isolated(library_.name, call, strict,
                        {.silence_s = options_.get_number("silence_s"),
                         .memory_mib = options_.get_number("memory_mib")});
      return;
    }
    try {
      call(strict);
    } catch (const ChildFailure& failure) {
      fail(failure.what());
    }
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw OptimizerFailure(fmt::format("optimizer '{}' {}", sanitize(library_.name), what));
  }

  Library library_;
  Options options_;
};

Capabilities make_capabilities(std::uint32_t bits) {
  const auto has = [bits](std::uint32_t bit) { return (bits & bit) != 0; };
  return {.bounds = has(ARMWRIGHT_BOUNDS),
          .constraints = has(ARMWRIGHT_CONSTRAINTS),
          .multi_objective = has(ARMWRIGHT_MULTI_OBJECTIVE),
          .batch = has(ARMWRIGHT_BATCH),
          .noisy = has(ARMWRIGHT_NOISY),
          .stochastic = has(ARMWRIGHT_STOCHASTIC),
          .generations = has(ARMWRIGHT_GENERATIONS),
          .local = has(ARMWRIGHT_LOCAL),
          .paced = has(ARMWRIGHT_PACED)};
}

void add_own_options(std::vector<OptionSpec>& options) {
  const IsolationLimits limits;
  options.push_back({.name = "isolate",
                     .description = "true: in a process of its own; false: in this one, faster, "
                                    "but a crash ends everything",
                     .fallback = true});
  options.push_back({.name = "silence_s",
                     .description = "isolated: longest time in seconds between two questions",
                     .fallback = limits.silence_s,
                     .lower = 0.1,
                     .upper = 1e6});
  options.push_back({.name = "memory_mib",
                     .description = "isolated: memory in MiB that it may allocate",
                     .fallback = limits.memory_mib,
                     .lower = 16,
                     .upper = 1e6});
}

}  // namespace

OptimizerRow load_library_plugin(const std::filesystem::path& file, const std::string& name,
                                 const IsolationLimits& loading) {
  const std::string shown = sanitize(file.string());
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: there is no such file; a plugin is a shared library, given by its "
                            "path or by its name in a folder of ARMWRIGHT_PLUGINS",
                            shown));
  }
  Library library{.name = name.empty() ? file.string() : name,
                  .file = std::filesystem::absolute(file),
                  .hash = calc_file_hash(file)};
  try {
    Description description = describe(library.file, loading);
    library.keeps_bounds = (description.capabilities & ARMWRIGHT_BOUNDS) != 0;
    add_own_options(description.options);
    return {.name = library.name,
            .summary = description.summary,
            .source = description.source,
            .capabilities = make_capabilities(description.capabilities),
            .options = description.options,
            .make = [library](const Options& options) -> std::unique_ptr<Optimizer> {
              return std::make_unique<LibraryOptimizer>(library, options);
            },
            .isolated = "with isolate=true",
            .input_hashes = {{file.filename().string(), library.hash}}};
  } catch (const Refusal& refusal) {
    throw Error(ErrorKind::bad_data, fmt::format("{}: {}", shown, refusal.what()));
  }
}

bool is_library_name(std::string_view name) {
  return name.find('/') != name.npos || name.ends_with(".so");
}

std::optional<std::filesystem::path> find_library_plugin(std::string_view name) {
  std::vector<std::filesystem::path> folders;
  const char* const given = std::getenv("ARMWRIGHT_PLUGINS");
  for (const std::string& folder : split(given == nullptr ? "" : given, ':')) {
    if (!folder.empty()) {
      folders.emplace_back(folder);
    }
  }
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (!error) {
    folders.push_back(program.parent_path().parent_path() / "lib" / "armwright" / "plugins");
  }
  for (const std::filesystem::path& folder : folders) {
    for (const char* prefix : {"", "lib"}) {
      const auto file = folder / fmt::format("{}{}.so", prefix, name);
      if (std::filesystem::is_regular_file(file, error)) {
        return file;
      }
    }
  }
  return std::nullopt;
}

}  // namespace armwright
