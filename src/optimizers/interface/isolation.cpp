#include "optimizers/interface/isolation.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <mutex>
#include <optional>

#include "base/text.hpp"
#include "process/child_process.hpp"
#include "process/packet.hpp"

namespace armwright {
namespace {

enum class Question : std::uint8_t {
  evaluate,
  remaining,
  stopped,
  begin_generation,
  recommend,
  explain_end
};

// The limit for consecutive requests without a point to evaluate. Such requests cost no budget,
// count as signs of life and, as recommendations, use memory of this process.
constexpr int kMostIdleQuestions = 100000;

const char* describe(Question question) {
  switch (question) {
    case Question::evaluate:
      return "evaluate() without points";
    case Question::remaining:
      return "remaining()";
    case Question::stopped:
      return "stopped()";
    case Question::begin_generation:
      return "begin_generation()";
    case Question::recommend:
      return "recommend()";
    case Question::explain_end:
      return "explain_end()";
  }
  return "nothing that is known";
}

// The Evaluator in the child. A body with threads may call it from any thread, one call at a time.
class RemoteEvaluator : public Evaluator {
 public:
  RemoteEvaluator(ParentLink& parent, const ProblemDescription& problem)
      : parent_(parent), problem_(problem) {}

  const ProblemDescription& problem() const override { return problem_; }

  std::vector<Score> evaluate(std::span<const std::vector<double>> points) override {
    PacketWriter question;
    question.put(Question::evaluate);
    question.put(std::uint64_t{points.size()});
    for (const std::vector<double>& point : points) {
      question.put(std::span<const double>(point));
    }
    const std::string answer = ask(question);
    PacketReader reader(answer);
    std::vector<Score> scores(reader.get<std::uint64_t>());
    for (Score& score : scores) {
      score.objectives = reader.get_numbers();
      score.constraint_values = reader.get_numbers();
      score.residuals = reader.get_numbers();
      score.status = reader.get<EvaluationStatus>();
      score.clipped = reader.get<bool>();
    }
    return scores;
  }

  bool stopped() const override {
    const std::string answer = ask(Question::stopped);
    return PacketReader(answer).get<bool>();
  }
  std::int64_t remaining() const override {
    const std::string answer = ask(Question::remaining);
    return PacketReader(answer).get<std::int64_t>();
  }
  void begin_generation() override { ask(Question::begin_generation); }
  void recommend(std::span<const double> x) override {
    PacketWriter question;
    question.put(Question::recommend);
    question.put(x);
    ask(question);
  }
  void explain_end(std::string_view reason) override {
    PacketWriter question;
    question.put(Question::explain_end);
    question.put(reason);
    ask(question);
  }

 private:
  std::string ask(const PacketWriter& question) const {
    const std::lock_guard lock(mutex_);
    return parent_.ask(question.bytes());
  }
  std::string ask(Question question) const {
    PacketWriter writer;
    writer.put(question);
    return ask(writer);
  }

  ParentLink& parent_;
  const ProblemDescription& problem_;
  mutable std::mutex mutex_;
};

// The parent's side: answers the requests of the child with the real Evaluator.
class Answerer {
 public:
  Answerer(const std::string& name, Evaluator& evaluator) : name_(name), evaluator_(evaluator) {}

  std::string answer(const std::string& question) {
    PacketReader reader(question);
    PacketWriter writer;
    const auto kind = reader.get<Question>();
    if (++idle_questions_ > kMostIdleQuestions && !evaluator_.stopped()) {
      fail(fmt::format("asked {} questions in a row without evaluating a point (the last: {})",
                       kMostIdleQuestions, describe(kind)));
    }
    switch (kind) {
      case Question::evaluate:
        answer_evaluate(reader, writer);
        break;
      case Question::remaining:
        writer.put(evaluator_.remaining());
        break;
      case Question::stopped:
        writer.put(evaluator_.stopped());
        break;
      case Question::begin_generation:
        evaluator_.begin_generation();
        break;
      case Question::recommend: {
        const std::vector<double> point = reader.get_numbers();
        check_point(point, [] { return "recommended a point"; });
        evaluator_.recommend(point);
        break;
      }
      case Question::explain_end:
        evaluator_.explain_end(reader.get_text());
        break;
    }
    return writer.bytes();
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw OptimizerFailure(
        fmt::format("optimizer '{}' {} after {} evaluation{}; what it had asked for is kept",
                    sanitize(name_), what, evaluations_, evaluations_ == 1 ? "" : "s"));
  }

 private:
  void answer_evaluate(PacketReader& reader, PacketWriter& writer) {
    if (evaluator_.stopped()) {  // whatever it asks for, there are no scores
      writer.put(std::uint64_t{0});
      return;
    }
    std::vector<std::vector<double>> points;
    for (auto left = reader.get<std::uint64_t>(); left > 0; --left) {
      points.push_back(reader.get_numbers());
      check_point(points.back(), [&] {
        return fmt::format("asked for a point (evaluation {})", evaluations_ + std::ssize(points));
      });
    }
    const std::vector<Score> scores = evaluator_.evaluate(points);
    evaluations_ += std::ssize(scores);
    idle_questions_ = points.empty() ? idle_questions_ : 0;
    writer.put(std::uint64_t{scores.size()});
    for (const Score& score : scores) {
      writer.put(std::span<const double>(score.objectives));
      writer.put(std::span<const double>(score.constraint_values));
      writer.put(std::span<const double>(score.residuals));
      writer.put(score.status);
      writer.put(score.clipped);
    }
  }

  // `describe_doing` says what the child was doing.
  void check_point(std::span<const double> point, const auto& describe_doing) const {
    const std::vector<DecisionVariable>& variables = evaluator_.problem().variables;
    if (point.size() != variables.size()) {
      fail(fmt::format("{} of {} coordinates for {} decision variables", describe_doing(),
                       point.size(), variables.size()));
    }
    for (std::size_t i = 0; i < point.size(); ++i) {
      if (!std::isfinite(point[i])) {
        fail(fmt::format("{} with {} = {}, which is not a finite number", describe_doing(),
                         variables[i].name, point[i]));
      }
    }
  }

  const std::string& name_;
  Evaluator& evaluator_;
  std::int64_t evaluations_ = 0;
  int idle_questions_ = 0;
};

// The time that the child has after the evaluator has stopped.
class Farewell {
 public:
  Farewell(const Evaluator& evaluator, double duration_s)
      : evaluator_(evaluator), duration_(duration_s) {}

  // Returns whether the evaluator has stopped and the time since then is over.
  bool is_over() {
    if (!evaluator_.stopped()) {
      return false;
    }
    const auto now = Clock::now();
    begin_ = begin_.value_or(now);
    return now - *begin_ >= duration_;
  }

 private:
  using Clock = std::chrono::steady_clock;

  const Evaluator& evaluator_;
  std::chrono::duration<double> duration_;
  std::optional<Clock::time_point> begin_;
};

}  // namespace

void minimize_isolated(const std::string& name, const std::function<void(Evaluator&)>& body,
                       Evaluator& evaluator, const ProcessLimits& limits, OutputLog* log,
                       double farewell_s) {
  if (evaluator.stopped()) {
    return;
  }
  ChildProcess child(
      [&](ParentLink& parent) {
        RemoteEvaluator remote(parent, evaluator.problem());
        body(remote);
      },
      limits, log);
  Answerer answerer(name, evaluator);
  const auto fail = [&](const ChildFailure& failure) {
    const std::string limit = limits.are_options ? failure.limit() : "";
    answerer.fail(failure.what() + (limit.empty() ? "" : fmt::format(" (option {})", limit)));
  };
  Farewell farewell(evaluator, farewell_s);
  const auto is_over = [&] { return farewell.is_over(); };
  const auto next_question = [&]() -> std::optional<std::string> {
    try {
      std::string question;
      const auto event = child.receive(is_over, question);
      return event == ChildProcess::Event::message ? std::optional(question) : std::nullopt;
    } catch (const ChildFailure& failure) {
      if (!evaluator.stopped()) {
        fail(failure);
      }
    }
    return std::nullopt;
  };
  while (const auto question = next_question()) {
    try {
      if (child.send(answerer.answer(*question), is_over)) {
        return;
      }
    } catch (const ChildFailure& failure) {
      if (evaluator.stopped()) {
        return;
      }
      fail(failure);
    } catch (const PacketError&) {
      answerer.fail("sent a question that makes no sense");
    }
  }
}

std::vector<OptionSpec> make_isolation_options() {
  const ProcessLimits limits;
  return {{.name = "silence_s",
           .description = "longest time in seconds between two questions",
           .fallback = limits.silence_s,
           .lower = 0.1,
           .upper = 1e6,
           .changes_result = false},
          {.name = "memory_mib",
           .description =
               "memory in MiB that its process may take beyond what it began with: of a library "
               "private writable memory, of a program resident memory",
           .fallback = limits.memory_mib,
           .lower = 1,
           .upper = 1e9,
           .changes_result = false},
          {.name = "log",
           .description = "file that what it prints is added to; empty: optimizer.log in the run's "
                          "folder",
           .fallback = std::string(),
           .changes_result = false}};
}

}  // namespace armwright
