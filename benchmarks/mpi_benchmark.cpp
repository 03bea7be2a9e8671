// Compares batches shared out over ranks with the same batches on one thread of one process, and
// measures the cost of a message. Start it with mpirun, with one thread per rank:
//
//     mpirun.openmpi --enable-recovery -n 2 build/release/bin/mpi_benchmark
//
// (--oversubscribe for more ranks than cores.) Rank 0 measures, the others work for it.
// Requirements with as many ranks as cores: an efficiency of 0.9 for batches of at least 40 pairs
// of 5 ms, and a speedup of at least 1 for any batch of pairs of 50 us, minus 0.05 for the
// machine's noise. docs/scaling.md explains the output.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "measure.hpp"
#include "study/executor/coordinator.hpp"
#include "study/executor/mpi_transport.hpp"
#include "study/executor/worker.hpp"
#include "synthetic_problem.hpp"

namespace armwright {
namespace {

constexpr BatchSize kOde{}, kLanes{.granularity = 8, .largest = 64};
constexpr const char* kIdentity = R"("mpi_benchmark")";
constexpr char kBegin = '!';  // ends the echoes and starts the worker

// The problems of both sides, in the same order.
struct Problems {
  SyntheticProblem ode{kOde}, lanes{kLanes};
  std::vector<const Problem*> list() const { return {&ode, &lanes}; }
};

// The work of ranks above 0: they return every message without pauses until kBegin, then simulate.
int serve(MessageTransport& transport) {
  while (true) {
    auto message = transport.receive();
    if (!message) {
      continue;
    }
    if (message->bytes == std::string(1, kBegin)) {
      break;
    }
    transport.send(0, std::move(message->bytes));
  }
  const Problems problems;
  bool in_order = false;
  {
    Worker worker(transport, problems.list(),
                  {.host = "here", .cpu = "", .threads = 1, .identity = kIdentity, .failure = ""});
    in_order = worker.serve() == Worker::End::finalize;
  }
  if (!in_order) {
    ::_exit(1);  // a regular end would wait for all ranks
  }
  close_mpi();
  return 0;
}

// Links that count the messages that pass through them.
class CountingTransport final : public MessageTransport {
 public:
  explicit CountingTransport(MessageTransport& transport) : transport_(transport) {}
  std::size_t rank() const override { return transport_.rank(); }
  std::size_t size() const override { return transport_.size(); }
  void send(std::size_t to, std::string message) override {
    ++sent_;
    bytes_ += message.size();
    transport_.send(to, std::move(message));
  }
  std::optional<Message> receive() override {
    auto message = transport_.receive();
    bytes_ += message ? message->bytes.size() : 0;
    return message;
  }
  double sent() const { return static_cast<double>(sent_); }
  double bytes() const { return static_cast<double>(bytes_); }

 private:
  MessageTransport& transport_;
  std::atomic<std::uint64_t> sent_ = 0, bytes_ = 0;
};

// Rank 0's side: the coordinator and its measurements.
class Leader {
 public:
  explicit Leader(MessageTransport& transport) : transport_(transport) {}
  // Returns whether all ranks have ended in order.
  bool end() {
    begin_work();
    coordinator_.reset();
    return end_workers(transport_, 5);
  }

  CountingTransport& transport() { return transport_; }
  bool has_workers() const { return coordinator_ != nullptr; }
  const Problems& problems() const { return problems_; }
  double iterations(double seconds) const { return seconds * iterations_per_s_; }
  std::size_t cores() const {
    return std::min<std::size_t>(transport_.size(), std::thread::hardware_concurrency());
  }
  Coordinator& coordinator() {
    begin_work();
    return *coordinator_;
  }

 private:
  void begin_work() {
    if (coordinator_) {
      return;
    }
    for (std::size_t rank = 1; rank < transport_.size(); ++rank) {
      transport_.send(rank, std::string(1, kBegin));
    }
    coordinator_ = std::make_unique<Coordinator>(
        transport_, problems_.list(), kIdentity, CoordinatorSettings{},
        [](const std::string& message) { fmt::print(stderr, "mpi_benchmark: {}\n", message); });
    while (coordinator_->expects_workers()) {
      ::usleep(1000);
    }
  }

  CountingTransport transport_;
  const Problems problems_;
  const double iterations_per_s_ = measure_iterations_per_s();
  std::unique_ptr<Coordinator> coordinator_;
};

// Sends a message to a rank and back, while both ranks only wait for messages.
void round_trip(benchmark::State& state, Leader& leader) {
  if (leader.has_workers()) {
    state.SkipWithError("the other ranks are at work already");
    return;
  }
  const std::string message(static_cast<std::size_t>(state.range(0)), 'x');
  for (auto _ : state) {
    leader.transport().send(1, message);
    while (!leader.transport().receive()) {
    }
  }
}

// Runs both sides alternately, so that any disturbance of the machine affects both.
void batch(benchmark::State& state, Leader& leader) {
  constexpr double kTurn_s = 0.04, kAll_s = 1.2;
  constexpr int kLeastRounds = 3;
  const bool has_lanes = state.range(2) > 1;
  const SyntheticBatch batch(has_lanes ? leader.problems().lanes : leader.problems().ode,
                             static_cast<std::size_t>(state.range(0)),
                             leader.iterations(1e-6 * static_cast<double>(state.range(1))));
  StopSignal stop;
  ThreadExecutor one(1);
  Coordinator& ranks = leader.coordinator();
  for (int i = 0; i < 3; ++i) {
    ranks.run(batch.get(), stop);  // measures the costs
  }
  const double first_s = measure_s([&] { one.run(batch.get(), stop); });
  const int repeats = std::max(1, static_cast<int>(kTurn_s / first_s));
  const auto measure = [&](CaseExecutor& executor) {
    return measure_s([&] {
             for (int i = 0; i < repeats; ++i) {
               executor.run(batch.get(), stop);
             }
           }) /
           repeats;
  };
  std::vector<double> times_one_s, times_ranks_s, ratios;
  // The cost of rounds with ranks, without that of the pairs.
  double chunks = 0, bytes = 0, communication_s = 0;
  const auto count = [&](double sign) {
    chunks += sign * leader.transport().sent();
    bytes += sign * leader.transport().bytes();
    communication_s +=
        sign * (read_clock_s(CLOCK_PROCESS_CPUTIME_ID) - read_clock_s(CLOCK_THREAD_CPUTIME_ID));
  };
  for (auto _ : state) {
    const double start_s = read_clock_s(CLOCK_MONOTONIC);
    while (std::ssize(ratios) < kLeastRounds || read_clock_s(CLOCK_MONOTONIC) - start_s < kAll_s) {
      times_one_s.push_back(measure(one));
      count(-1);
      times_ranks_s.push_back(measure(ranks));
      count(1);
      ratios.push_back(times_one_s.back() / times_ranks_s.back());
    }
    state.SetIterationTime(calc_median(times_ranks_s));
  }
  const double speedup = calc_median(ratios);
  state.counters["one_s"] = calc_median(times_one_s);
  state.counters["ranks_s"] = calc_median(times_ranks_s);
  state.counters["speedup"] = speedup;
  state.counters["efficiency"] = speedup / static_cast<double>(leader.cores());
  const double batches = static_cast<double>(ratios.size()) * repeats;
  state.counters["chunks"] = chunks / batches;
  state.counters["bytes"] = bytes / batches;
  state.counters["communication_s"] = communication_s / batches;  // of the communicating thread
  state.counters["rounds"] = static_cast<double>(ratios.size());
}

void add_benchmarks(Leader& leader) {
  const auto with_leader = [&leader](auto function) {
    return [&leader, function](benchmark::State& state) { function(state, leader); };
  };
  benchmark::RegisterBenchmark("round_trip", with_leader(round_trip))
      ->ArgName("bytes")
      ->Arg(0)
      ->Arg(1'000)
      ->Arg(10'000)
      ->Arg(100'000)
      ->UseRealTime()
      ->Unit(benchmark::kMicrosecond);
  benchmark::RegisterBenchmark("batch", with_leader(batch))
      ->ArgNames({"pairs", "cost_us", "lanes"})
      ->ArgsProduct({{200, 40, 8, 1}, {5000}, {1}})
      ->ArgsProduct({{1000, 35}, {500}, {1}})
      ->ArgsProduct({{1000, 200, 35}, {50}, {1, 8}})
      ->Iterations(1)
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond);
}

int lead(MessageTransport& transport, int argc, char** argv) {
  Leader leader(transport);
  benchmark::AddCustomContext("ranks", std::to_string(transport.size()));
  benchmark::AddCustomContext("cores", std::to_string(std::thread::hardware_concurrency()));
  add_benchmarks(leader);
  benchmark::Initialize(&argc, argv);
  const bool understood = !benchmark::ReportUnrecognizedArguments(argc, argv);
  if (understood) {
    benchmark::RunSpecifiedBenchmarks();
  }
  std::fflush(nullptr);
  if (!leader.end()) {
    ::_exit(1);
  }
  close_mpi();
  return understood ? 0 : 1;
}

}  // namespace
}  // namespace armwright

int main(int argc, char** argv) {
  using namespace armwright;
  const auto place = find_rank_place();
  if (!place) {
    fmt::print(stderr,
               "mpi_benchmark: start it by mpirun.openmpi --enable-recovery -n 2 {}, as there is "
               "nothing to measure without other ranks\n",
               argc > 0 ? argv[0] : "mpi_benchmark");
    return 1;
  }
  const auto transport = open_mpi_transport();
  return place->rank == 0 ? lead(*transport, argc, argv) : serve(*transport);
}
