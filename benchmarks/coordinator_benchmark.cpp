// Measures the coordinator's own work without MPI: the real coordinator with simulated ranks. A
// simulated rank is an entry in a table that answers after the time that its pairs would take. It
// costs almost nothing, so thousands of ranks fit into one process. The benchmark reports what one
// coordinator can do: chunks and pairs per second, and how many ranks it keeps busy.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <queue>
#include <string>
#include <vector>

#include "measure.hpp"
#include "study/executor/case_packets.hpp"
#include "study/executor/coordinator.hpp"
#include "synthetic_problem.hpp"

namespace armwright {
namespace {

constexpr const char* kIdentity = R"("coordinator_benchmark")";

// Links to simulated ranks: a table of the times at which they answer.
class CrowdTransport final : public MessageTransport {
 public:
  CrowdTransport(std::size_t ranks, std::size_t threads, double pair_s)
      : pair_s_(pair_s), threads_(threads), free_at_s_(ranks + 1, 0) {
    const std::string ready = make_rank_message(WorkerIntroduction{
        .host = "crowd", .cpu = "", .threads = threads, .identity = kIdentity, .failure = ""});
    for (std::size_t rank = 1; rank <= ranks; ++rank) {
      due_.push({.at_s = 0, .from = rank, .bytes = ready});
    }
  }

  std::size_t rank() const override { return 0; }
  std::size_t size() const override { return free_at_s_.size(); }

  void send(std::size_t to, std::string message) override {
    const double start_s = now_s();
    if (!message.empty() && message.front() == static_cast<char>(RankMessage::chunk)) {
      answer(to, message);
    }
    spent_s_ += now_s() - start_s;
  }

  std::optional<Message> receive() override {
    const double start_s = now_s();
    if (due_.empty() || due_.top().at_s > start_s) {
      return std::nullopt;
    }
    std::optional<Message> message(Message{.from = due_.top().from, .bytes = due_.top().bytes});
    due_.pop();
    spent_s_ += now_s() - start_s;
    return message;
  }

  // Chunks so far, their bytes in both directions, and the time that the simulated ranks have used
  // on the coordinator's thread. Call it only between batches.
  double chunks() const { return chunks_; }
  double bytes() const { return bytes_; }
  double spent_s() const { return spent_s_; }

 private:
  struct Due {
    double at_s;
    std::size_t from;
    std::string bytes;
    bool operator<(const Due& other) const { return at_s > other.at_s; }  // the earliest on top
  };

  static double now_s() { return read_clock_s(CLOCK_MONOTONIC); }

  // All points have the same size (put_jobs()), so the message's size gives the number of pairs.
  static std::size_t count_pairs(const std::string& message) {
    constexpr std::size_t kPair = (1 + SyntheticProblem::kVariables) * sizeof(double) + 16;
    return message.size() / kPair;
  }

  void answer(std::size_t rank, const std::string& message) {
    const std::size_t pairs = count_pairs(message);
    std::string& body = bodies_[pairs];
    if (body.empty()) {
      PacketWriter packet;
      put_outcomes(packet, std::vector<CaseOutcome>(pairs, SyntheticProblem::make_outcome(1)));
      body = packet.bytes();
    }
    std::uint64_t chunk = 0;
    std::memcpy(&chunk, message.data() + 1, sizeof chunk);
    PacketWriter packet;
    packet.put(RankMessage::outcomes);
    packet.put(chunk);
    packet.put(pair_s_);
    const double rounds =
        static_cast<double>((pairs + threads_ - 1) / threads_);  // of all its threads
    free_at_s_[rank] = std::max(free_at_s_[rank], now_s()) + rounds * pair_s_;
    ++chunks_;
    bytes_ += static_cast<double>(message.size() + packet.bytes().size() + body.size());
    due_.push({.at_s = free_at_s_[rank], .from = rank, .bytes = packet.bytes() + body});
  }

  const double pair_s_;
  const std::size_t threads_;
  std::vector<double> free_at_s_;
  std::map<std::size_t, std::string> bodies_;  // the same outcomes for all, by their number
  std::priority_queue<Due> due_;
  double chunks_ = 0, bytes_ = 0, spent_s_ = 0;
};

// Measures the encoding and decoding of `pairs` pairs alone.
void packets(benchmark::State& state) {
  const auto pairs = static_cast<std::size_t>(state.range(0));
  const SyntheticProblem problem({});
  const SyntheticBatch batch(problem, pairs, 1);
  PacketWriter answer;
  put_outcomes(answer, std::vector<CaseOutcome>(pairs, SyntheticProblem::make_outcome(1)));
  for (auto _ : state) {
    PacketWriter jobs;
    put_jobs(jobs, batch.get(), 0, pairs);
    benchmark::DoNotOptimize(jobs.bytes().data());
    PacketReader reader(answer.bytes());
    benchmark::DoNotOptimize(get_outcomes(reader).data());
  }
}

// The coordinator has one computing thread, which simulates pairs of the same cost.
void crowd(benchmark::State& state) {
  constexpr double kAll_s = 1.0;
  const auto ranks = static_cast<std::size_t>(state.range(0));
  const auto threads = static_cast<std::size_t>(state.range(1));
  const double pair_s = 1e-6 * static_cast<double>(state.range(2));
  const auto pairs = static_cast<std::size_t>(state.range(3));
  const SyntheticProblem problem({});
  const SyntheticBatch batch(problem, pairs, pair_s * measure_iterations_per_s());
  CrowdTransport transport(ranks - 1, threads, pair_s);
  StopSignal stop;
  std::vector<double> times_s;
  double chunks = 0, bytes = 0, processor_s = 0, transport_s = 0;
  {
    Coordinator coordinator(transport, {&problem}, kIdentity, {}, [](const std::string&) {});
    while (coordinator.expects_workers()) {
      ::usleep(1000);
    }
    coordinator.run(batch.get(), stop);  // measures the cost per pair
    for (auto _ : state) {
      const double start_s = read_clock_s(CLOCK_MONOTONIC);
      const double cpu_before_s = read_clock_s(CLOCK_PROCESS_CPUTIME_ID);
      const double transport_before_s = transport.spent_s();
      const double chunks_before = transport.chunks(), bytes_before = transport.bytes();
      while (times_s.size() < 3 || read_clock_s(CLOCK_MONOTONIC) - start_s < kAll_s) {
        const double cpu_s = read_clock_s(CLOCK_THREAD_CPUTIME_ID);
        times_s.push_back(measure_s([&] { coordinator.run(batch.get(), stop); }));
        processor_s -= read_clock_s(CLOCK_THREAD_CPUTIME_ID) - cpu_s;
      }
      transport_s = transport.spent_s() - transport_before_s;
      processor_s += read_clock_s(CLOCK_PROCESS_CPUTIME_ID) - cpu_before_s - transport_s;
      const auto batches = static_cast<double>(times_s.size());
      chunks = (transport.chunks() - chunks_before) / batches;
      bytes = (transport.bytes() - bytes_before) / batches;
      processor_s /= batches;
      transport_s /= batches;
      state.SetIterationTime(calc_median(times_s));
    }
  }
  const double all_threads = 1 + static_cast<double>((ranks - 1) * threads);
  state.counters["chunks"] = chunks;
  state.counters["bytes"] = bytes;
  state.counters["communication_s"] = processor_s;  // of the communicating thread, per batch
  state.counters["links_s"] = transport_s;          // the simulated ranks' share of that thread
  state.counters["efficiency"] =
      static_cast<double>(pairs) * pair_s / calc_median(times_s) / all_threads;
}

BENCHMARK(packets)->ArgName("pairs")->Arg(1)->Arg(10)->Arg(100)->Arg(1000);
BENCHMARK(crowd)
    ->ArgNames({"ranks", "threads", "cost_us", "pairs"})
    ->Args({2, 1, 5000, 40})
    ->Args({10, 1, 5000, 1000})
    ->Args({100, 1, 5000, 10'000})
    ->Args({1000, 1, 5000, 100'000})
    ->Args({10'000, 1, 5000, 100'000})
    ->Args({1000, 16, 5000, 100'000})
    ->Args({10, 1, 50, 10'000})
    ->Args({100, 1, 50, 100'000})
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace armwright

BENCHMARK_MAIN();
