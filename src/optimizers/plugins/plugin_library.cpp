#include "optimizers/plugins/plugin_library.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <memory>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"
#include "optimizers/plugins/plugin_call.hpp"
#include "optimizers/plugins/plugin_description.hpp"
#include "optimizers/plugins/recorded_optimizer.hpp"
#include "process/child_process.hpp"
#include "process/command_words.hpp"
#include "process/output_log.hpp"
#include "process/packet.hpp"
#include "process/process_watch.hpp"

namespace armwright {
namespace {

// The options that every library has in addition to its own.
std::vector<OptionSpec> make_own_options() {
  std::vector<OptionSpec> options = {
      {.name = "isolate",
       .description = "true: in a process of its own; false: in this one, faster, but neither "
                      "watched nor logged, and a crash ends everything",
       .fallback = true,
       .changes_result = false}};
  std::ranges::move(make_isolation_options(), std::back_inserter(options));
  return options;
}

// Opens the library in a child process, which sends (true, description) or (false, reason).
PluginDescription describe(const std::filesystem::path& file, const ProcessLimits& limits) {
  std::vector<std::string> own_options;
  for (const OptionSpec& option : make_own_options()) {
    own_options.push_back(option.name);
  }
  std::string message;
  OutputLog log;
  try {
    ChildProcess child(
        [&](ParentLink& parent) {
          PacketWriter writer;
          try {
            const PluginDescription description = describe_plugin(open_plugin(file), own_options);
            writer.put(true);
            pack(description, writer);
          } catch (const PluginRefusal& refusal) {
            writer.put(false);
            writer.put(std::string_view(refusal.what()));
          }
          parent.send(writer.bytes());
        },
        limits, &log);
    if (child.receive([] { return false; }, message) != ChildProcess::Event::message) {
      throw PluginRefusal("said nothing");
    }
    PacketReader reader(message);
    if (!reader.get<bool>()) {
      throw PluginRefusal(sanitize(reader.get_text()));
    }
    return unpack_description(reader);
  } catch (const ChildFailure& failure) {
    throw PluginRefusal(fmt::format("cannot be used: while it was opened, it {}{}", failure.what(),
                                    describe_printed(log.last_lines())));
  } catch (const PacketError&) {
    throw PluginRefusal("cannot be used: while it was opened, it sent what makes no sense");
  }
}

// Checks that a plugin does only what it has declared, in any process.
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
  void explain_end(std::string_view reason) override { evaluator_.explain_end(reason); }

 private:
  // `describe_doing` says what the plugin was doing.
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

  void log_to(const std::filesystem::path& file) override {
    auto log = std::make_unique<OutputLog>(file, OutputLog::Begin::anew);
    if (options_.get_text("log").empty()) {
      log_ = std::move(log);
    }
  }

  void minimize(Evaluator& evaluator, std::uint64_t seed) override {
    if (calc_program_hash(library_.file) != library_.hash) {
      fail("is no longer the file that it was when this program started");
    }
    StrictEvaluator strict(library_.name, library_.keeps_bounds, evaluator);
    const auto call = [&](Evaluator& any) {
      try {
        call_plugin(open_plugin(library_.file), options_, any, seed);
      } catch (const PluginRefusal& refusal) {
        throw ChildFailure(refusal.what());
      }
    };
    if (!options_.get_bool("isolate")) {
      try {
        call(strict);
      } catch (const ChildFailure& failure) {
        fail(failure.what());
      }
      return;
    }
    open_log();
    try {
      minimize_isolated(library_.name, call, strict,
                        {.silence_s = options_.get_number("silence_s"),
                         .memory_mib = options_.get_number("memory_mib"),
                         .are_options = true},
                        log_.get(), kFarewell_s);
    } catch (const OptimizerFailure& failure) {
      throw OptimizerFailure(failure.what(), log_->last_lines());
    }
  }

 private:
  // Not earlier, because a caller may make an optimizer and then have nothing to run.
  void open_log() {
    if (!log_) {
      log_ = std::make_unique<OutputLog>(options_.get_text("log"),
                                         OutputLog::Begin::behind_what_is_there);
    }
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw OptimizerFailure(fmt::format("optimizer '{}' {}", sanitize(library_.name), what));
  }

  Library library_;
  Options options_;
  std::unique_ptr<OutputLog> log_;  // from the first minimize() on, or log_to()
};

Capabilities make_capabilities(std::uint32_t bits) {
  const auto has = [bits](std::uint32_t bit) { return (bits & bit) != 0; };
  return {.bounds = has(ARMWRIGHT_BOUNDS),
          .constraints = has(ARMWRIGHT_CONSTRAINTS),
          .multi_objective = has(ARMWRIGHT_MULTI_OBJECTIVE),
          .batch = has(ARMWRIGHT_BATCH),
          .noisy = has(ARMWRIGHT_NOISY),
          .residuals = has(ARMWRIGHT_RESIDUALS),
          .stochastic = has(ARMWRIGHT_STOCHASTIC),
          .generations = has(ARMWRIGHT_GENERATIONS),
          .local = has(ARMWRIGHT_LOCAL),
          .sampling = has(ARMWRIGHT_SAMPLING),
          .paced = has(ARMWRIGHT_PACED),
          .integer = has(ARMWRIGHT_INTEGERS),
          .categorical = has(ARMWRIGHT_CATEGORIES)};
}

}  // namespace

OptimizerRow load_library_plugin(const std::filesystem::path& file, const std::string& name,
                                 const ProcessLimits& loading) {
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
                  .hash = calc_program_hash(file)};
  try {
    const PluginDescription description = describe(library.file, loading);
    library.keeps_bounds = (description.capabilities & ARMWRIGHT_BOUNDS) != 0;
    OptimizerRow row;
    row.summary = description.summary;
    row.source = description.source;
    row.capabilities = make_capabilities(description.capabilities);
    row.options = description.options;
    row.make = [library](const Options& options) -> std::unique_ptr<Optimizer> {
      return std::make_unique<LibraryOptimizer>(library, options);
    };
    row.requirements = description.requirements;
    row.isolated = "with isolate=true";
    row.input_hashes = {{file.filename().string(), library.hash}};
    row.short_name = name.empty() ? description.name : "";
    row.description = make_description(row);
    row.name = library.name;
    std::ranges::move(make_own_options(), std::back_inserter(row.options));
    return row;
  } catch (const PluginRefusal& refusal) {
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
