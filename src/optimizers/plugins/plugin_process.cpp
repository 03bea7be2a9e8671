#include "optimizers/plugins/plugin_process.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"
#include "optimizers/interface/isolation.hpp"
#include "optimizers/plugins/plugin_messages.hpp"
#include "optimizers/plugins/recorded_optimizer.hpp"
#include "process/command_words.hpp"
#include "process/line_process.hpp"
#include "process/output_log.hpp"
#include "process/process_watch.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr int kMostNotes = 100000;  // recommendations without a question between them

std::vector<std::string> watch_option_names() {
  std::vector<std::string> names;
  std::ranges::transform(make_isolation_options(), std::back_inserter(names), &OptionSpec::name);
  return names;
}

// Returns nothing if `is_given_up` becomes true before the answer. Silence is an ordinary failure
// here; the option silence_s does not apply.
std::optional<json> ask_for_description(LineProcess& child, double loading_s,
                                        const std::function<bool()>& is_given_up) {
  try {
    child.send(make_hello(), loading_s);
    const auto line = child.receive(loading_s, is_given_up);
    return line ? std::optional(read_message(*line)) : std::nullopt;
  } catch (const LineProcessSilence& silence) {
    throw LineProcessFailure(fmt::format("{}, asked to describe itself", silence.what()));
  }
}

class ProcessPlugin : public Optimizer {
 public:
  ProcessPlugin(std::string name, std::vector<std::string> words, json description,
                double loading_s, Capabilities capabilities, Options options)
      : name_(std::move(name)),
        words_(std::move(words)),
        description_(std::move(description)),
        loading_s_(loading_s),
        capabilities_(capabilities),
        options_(std::move(options)),
        silence_s_(options_.get_number("silence_s")) {}

  void log_to(const std::filesystem::path& file) override {
    auto log = std::make_unique<OutputLog>(file, OutputLog::Begin::anew);
    if (options_.get_text("log").empty()) {
      log_ = std::move(log);
    }
  }

  void minimize(Evaluator& evaluator, std::uint64_t seed) override {
    if (evaluator.stopped()) {
      return;
    }
    open_log();
    std::int64_t evaluations = 0;
    try {
      Conversation(*this, evaluator, evaluations).run(seed);
    } catch (const ProtocolError& error) {
      fail(error.what(), evaluations);
    } catch (const LineProcessSilence& error) {
      fail(fmt::format("{} (option silence_s)", error.what()), evaluations);
    } catch (const LineProcessFailure& error) {
      fail(error.what(), evaluations);
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

  // One process from its start to its end. The destructor kills it.
  class Conversation {
   public:
    Conversation(ProcessPlugin& plugin, Evaluator& evaluator, std::int64_t& evaluations)
        : plugin_(plugin),
          evaluator_(evaluator),
          evaluations_(evaluations),
          child_(plugin.words_, *plugin.log_) {}

    void run(std::uint64_t seed) {
      try {
        converse(seed);
      } catch (const ProtocolError&) {
        if (!end_ || is_recommending_) {
          throw;
        }
      } catch (const LineProcessFailure&) {
        if (!end_) {  // how it ends once it has been told to is its own affair
          throw;
        }
      }
    }

   private:
    void converse(std::uint64_t seed) {
      const auto description =
          ask_for_description(child_, plugin_.loading_s_, [&] { return evaluator_.stopped(); });
      if (!description) {
        return;
      }
      if (*description != plugin_.description_) {
        throw ProtocolError("describes itself differently from one start to the next");
      }
      child_.limit_memory(plugin_.options_.get_number("memory_mib"));
      child_.send(make_minimize(evaluator_.problem(), seed, plugin_.options_, watch_option_names(),
                                evaluator_.remaining()),
                  plugin_.silence_s_);
      int notes = 0;
      while (const auto line = child_.receive(plugin_.silence_s_, [&] { return is_over(); })) {
        const json message = read_message(*line);
        const std::string type = read_type(message);
        if (type == "done") {
          if (message.contains("reason")) {
            evaluator_.explain_end(read_text(message, "reason", "\"done\""));
          }
          finish();
          return;
        }
        if (type == "ask") {
          answer(message);
          notes = 0;
        } else if (type == "recommend") {
          is_recommending_ = true;
          evaluator_.recommend(read_recommendation(message, evaluator_.problem()));
          is_recommending_ = false;
          if (++notes > kMostNotes) {
            throw ProtocolError(
                fmt::format("sent {} recommendations without a question", kMostNotes));
          }
        } else {
          throw ProtocolError(
              fmt::format("sent a message of the unknown type '{}'; valid: ask, "
                          "recommend, done",
                          sanitize(type.substr(0, 80))));
        }
      }
    }

    void answer(const json& message) {
      if (evaluator_.stopped()) {  // while it was thinking: the evaluator is not to be bothered
        tell({});
        return;
      }
      const AskMessage ask = read_ask(message, evaluator_.problem(), plugin_.capabilities_.bounds);
      if (ask.begins_generation) {
        evaluator_.begin_generation();
      }
      const std::vector<Score> scores = evaluator_.evaluate(ask.points);
      evaluations_ += std::ssize(scores);
      tell(scores);
    }

    void tell(const std::vector<Score>& scores) {
      const bool stopped = evaluator_.stopped();
      if (stopped && !end_) {
        end_ = make_end();
      }
      child_.send(make_tell(scores, std::max<std::int64_t>(evaluator_.remaining(), 0), stopped,
                            plugin_.capabilities_.residuals),
                  stopped ? kFarewell_s : plugin_.silence_s_);
    }

    // The run has stopped, and the process has had enough time to notice.
    bool is_over() {
      if (!end_ && evaluator_.stopped()) {
        end_ = make_end();
      }
      return end_ && LineProcess::Clock::now() > *end_;
    }

    static LineProcess::Clock::time_point make_end() {
      return LineProcess::Clock::now() + std::chrono::duration_cast<LineProcess::Clock::duration>(
                                             std::chrono::duration<double>(kFarewell_s));
    }

    void finish() {
      const std::string exit = child_.finish(kFarewell_s);
      if (!exit.empty()) {
        throw LineProcessFailure(exit + " after it was done");
      }
    }

    ProcessPlugin& plugin_;
    Evaluator& evaluator_;
    std::int64_t& evaluations_;
    LineProcess child_;
    std::optional<LineProcess::Clock::time_point> end_;
    bool is_recommending_ = false;  // true while it reads a recommendation
  };

  [[noreturn]] void fail(const std::string& what, std::int64_t evaluations) const {
    throw OptimizerFailure(
        fmt::format("optimizer '{}' (exec:{}), after {} evaluation{}: it {}", name_,
                    sanitize(join(words_, " ")), evaluations, evaluations == 1 ? "" : "s", what),
        log_->last_lines());
  }

  std::string name_;
  std::vector<std::string> words_;
  json description_;
  double loading_s_;
  Capabilities capabilities_;
  Options options_;
  double silence_s_;
  std::unique_ptr<OutputLog> log_;  // from the first minimize() on, or log_to()
};

std::map<std::string, std::string> hash_files(const std::vector<std::string>& files) {
  std::map<std::string, std::string> hashes;
  for (const std::string& file : files) {
    hashes[file] = calc_program_hash(file);
  }
  return hashes;
}

void check_option_names(const OptimizerRow& row) {
  for (const OptionSpec& spec : make_isolation_options()) {
    if (std::ranges::count(row.options, spec.name, &OptionSpec::name) > 0) {
      throw ProtocolError(
          fmt::format("describes an option '{}'; every process has one of that name: {}", spec.name,
                      spec.description));
    }
  }
}

}  // namespace

OptimizerRow load_process_plugin(std::string_view command, double loading_s) {
  const std::vector<std::string> words = split_command(command, "optimizer");
  OutputLog log;
  try {
    LineProcess child(words, log);
    const json description = ask_for_description(child, loading_s, [] { return false; }).value();
    OptimizerRow row = read_description(description);
    check_option_names(row);
    row.description = make_description(row);
    child.send(make_quit(), kFarewell_s);
    child.finish(kFarewell_s);
    std::ranges::move(make_isolation_options(), std::back_inserter(row.options));
    row.isolated = "always";
    row.input_hashes = hash_files(list_program_files(command));
    row.make = [=, name = row.name, capabilities = row.capabilities](
                   const Options& options) -> std::unique_ptr<Optimizer> {
      return std::make_unique<ProcessPlugin>(name, words, description, loading_s, capabilities,
                                             options);
    };
    return row;
  } catch (const ProtocolError& error) {
    throw Error(ErrorKind::bad_data, fmt::format("optimizer 'exec:{}': it {}{}", sanitize(command),
                                                 error.what(), describe_printed(log.last_lines())));
  } catch (const LineProcessFailure& error) {
    throw Error(ErrorKind::bad_data,
                fmt::format("optimizer 'exec:{}': it {} before it described itself{}",
                            sanitize(command), error.what(), describe_printed(log.last_lines())));
  }
}

}  // namespace armwright
