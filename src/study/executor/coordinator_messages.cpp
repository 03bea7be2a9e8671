// What the coordinator has to do with workers: one thread's, which alone uses the links.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "base/json_text.hpp"
#include "base/text.hpp"
#include "study/executor/case_packets.hpp"
#include "study/executor/coordinator.hpp"

namespace armwright {
namespace {

using std::chrono::microseconds;

constexpr double kAliveEvery_s = 10;  // workers believe in a coordinator for far longer

double to_seconds(auto duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace

void Coordinator::communicate() {
  Lock lock(mutex_);
  awake_.restart();
  while (!stopping_) {
    has_news_ = false;
    assign();
    auto outgoing = std::exchange(outgoing_, {});
    auto notices = std::exchange(notices_, {});
    lock.unlock();
    for (auto& [rank, message] : outgoing) {
      links_.send(rank, std::move(message));
    }
    for (const std::string& notice : notices) {
      notify_(notice);
    }
    lock.lock();
    take_messages(lock);
    awake_.look();
    look_for_late();
    if (!stopping_ && !has_news_) {
      wake_communication_.wait_for(lock, calc_pause());
    }
  }
}

// As long as it may be without letting anybody wait.
microseconds Coordinator::calc_pause() const {
  constexpr microseconds kShortest{50}, kLongest{1000}, kIdle{20'000};
  if (sent_.empty()) {
    return kIdle;
  }
  const Clock::time_point now = Clock::now();
  microseconds pause = kLongest;
  for (std::size_t rank = 1; rank < workers_.size(); ++rank) {
    const Worker& worker = workers_[rank];
    if (worker.state == State::ready && worker.chunks > 0) {
      const auto expected = std::chrono::duration_cast<microseconds>(worker.free_at - now) /
                            (4 * static_cast<int>(worker.chunks));
      pause = std::min(pause, std::max(kShortest, expected));
    }
  }
  return pause;
}

// Round by round a chunk for each worker that is of use, as long as that is worth while. Of many
// ranks most have enough to do at any time: those cost no more than a look.
void Coordinator::assign() {
  const TeamSize team = calc_team();
  double left_here_s = calc_left_here_s();
  bool has_sent = std::ranges::any_of(
      batches_, [this](const auto& batch) { return batch->problem && count_untaken(*batch) > 0; });
  while (std::exchange(has_sent, false)) {
    for (std::size_t rank = 1; rank < workers_.size(); ++rank) {
      Worker& worker = workers_[rank];
      if (worker.state != State::ready || worker.chunks >= kChunksAhead) {
        continue;
      }
      const Clock::time_point now = Clock::now();
      worker.free_at = std::max(worker.free_at, now);
      const double unused_s = worker.chunks > 0 ? 0 : to_seconds(now - worker.heard_at);
      const WorkerLoad load{.threads = worker.introduction.threads,
                            .chunks = worker.chunks,
                            .busy_s = to_seconds(worker.free_at - now),
                            .latency_s = worker.latency.get_s(unused_s)};
      for (const auto& batch : batches_) {
        if (!batch->problem || batch->closed) {
          continue;
        }
        const std::size_t pairs =
            plan_remote_chunk(batch->cases->batch_size(), count_untaken(*batch), team,
                              batch->cost->get_s(), left_here_s, load);
        const PiecePointer piece = pairs > 0 ? take_piece(batch, pairs) : nullptr;
        if (piece) {
          send_chunk(rank, piece);
          left_here_s = calc_left_here_s();
          has_sent = true;
          break;
        }
      }
    }
  }
}

void Coordinator::send_chunk(std::size_t rank, const PiecePointer& piece) {
  Worker& worker = workers_[rank];
  const Clock::time_point now = Clock::now();
  PacketWriter packet;
  packet.put(RankMessage::chunk);
  packet.put(next_chunk_);
  packet.put(*piece->batch->problem);
  put_jobs(packet, *piece->batch->cases, piece->first, piece->count);
  outgoing_.emplace_back(rank, packet.bytes());
  sent_[next_chunk_++] = {.piece = piece,
                          .worker = rank,
                          .at = now,
                          .at_awake_s = awake_.get_s(),
                          .ahead_s = std::max(0.0, to_seconds(worker.free_at - now)),
                          .was_idle = worker.chunks == 0};
  ++worker.chunks;
  const double work_s = piece->batch->cost->get_s().value_or(0) *
                        static_cast<double>(piece->count) /
                        static_cast<double>(worker.introduction.threads);
  worker.free_at = std::max(worker.free_at, now) +
                   std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(
                       work_s + (worker.chunks == 1 ? worker.latency.get_s(0) : 0)));
}

// Not all that there are: whoever has answered waits for something new to do.
void Coordinator::take_messages(Lock& lock) {
  constexpr int kAtOnce = 256;
  for (int taken = 0; taken < kAtOnce; ++taken) {
    lock.unlock();
    const auto message = links_.receive();
    lock.lock();
    if (!message) {
      return;
    }
    has_news_ = true;
    try {
      take_message(lock, *message);
    } catch (const PacketError& error) {
      give_up(message->from, error.what());
    }
  }
}

void Coordinator::take_message(Lock& lock, const Links::Message& message) {
  PacketReader packet(message.bytes);
  Worker& worker = workers_.at(message.from);
  if (worker.state == State::late) {
    worker.state = State::ready;
    worker.patience *= 2;
    notices_.push_back(fmt::format("{} answers again", name_worker(message.from)));
  }
  switch (packet.get<RankMessage>()) {
    case RankMessage::ready:
      welcome(message.from, get_introduction(packet));
      return;
    case RankMessage::outcomes:
      take_outcomes(lock, message.from, packet);
      return;
    case RankMessage::failed:
      give_up(message.from, packet.get_text());
      return;
    default:
      throw PacketError("a worker says what it has no right to say");
  }
}

void Coordinator::welcome(std::size_t rank, WorkerIntroduction introduction) {
  Worker& worker = workers_[rank];
  worker.introduction = std::move(introduction);
  if (!worker.introduction.failure.empty()) {
    give_up(rank, worker.introduction.failure);
    return;
  }
  const auto differences = describe_differences(identity_, worker.introduction.identity);
  if (!differences.empty()) {
    give_up(rank, "it would compute something else (recorded: here, now: there):\n  " +
                      join(differences, "\n  "));
    return;
  }
  worker.state = State::ready;
  worker.free_at = worker.heard_at = Clock::now();
  // The same code everywhere but in the C library, which chooses its own by the processor.
  if (!settings_.cpu.empty() && worker.introduction.cpu != settings_.cpu) {
    notices_.push_back(
        fmt::format("note: {} has another processor ({}; here: {}). The last bits of results may "
                    "then depend on who computes them; for the same bits every time use machines "
                    "of one kind",
                    name_worker(rank), sanitize(worker.introduction.cpu), settings_.cpu));
  }
}

void Coordinator::take_outcomes(Lock& lock, std::size_t rank, PacketReader& packet) {
  const auto found = sent_.find(packet.get<std::uint64_t>());
  const auto pair_s = packet.get<double>();
  std::vector<CaseOutcome> outcomes = get_outcomes(packet);
  if (found == sent_.end() || found->second.worker != rank ||
      outcomes.size() != found->second.piece->count) {
    throw PacketError("a worker answers what it was not asked");
  }
  const Sent sent = std::move(found->second);
  sent_.erase(found);
  Worker& worker = workers_[rank];
  const Clock::time_point now = Clock::now();
  worker.heard_at = now;
  --worker.chunks;
  if (worker.chunks == 0) {
    worker.free_at = now;
  }
  const auto pairs = static_cast<double>(sent.piece->count);
  if (sent.was_idle) {
    const double work_s = pair_s * pairs / static_cast<double>(worker.introduction.threads);
    worker.latency.learn(std::max(0.0, to_seconds(now - sent.at) - work_s));
  }
  if (!sent.piece->batch->closed) {
    sent.piece->batch->cost->learn(pair_s * pairs, sent.piece->count);
  }
  deliver(lock, sent.piece, std::move(outcomes));
}

void Coordinator::give_up(std::size_t rank, const std::string& reason) {
  workers_[rank].state = State::useless;
  reassign(rank);
  notices_.push_back(fmt::format("warning: {} is of no use: {}", name_worker(rank), reason));
}

// What it owes goes to the others.
void Coordinator::reassign(std::size_t rank) {
  for (auto& [chunk, sent] : sent_) {
    Batch& batch = *sent.piece->batch;
    if (sent.worker == rank && !sent.piece->delivered && !batch.closed &&
        std::ranges::find(batch.again, sent.piece) == batch.again.end()) {
      batch.again.push_back(sent.piece);
    }
  }
  has_news_ = true;
  changed_.notify_all();
}

void Coordinator::look_for_late() {
  constexpr double kTolerance = 4;  // times what was expected
  // There may be thousands of chunks: not at every turn.
  constexpr double kLookEvery = 0.05;  // times the patience
  if (awake_.get_s() - last_look_s_ < kLookEvery * settings_.patience_s) {
    return;
  }
  last_look_s_ = awake_.get_s();
  for (auto& [chunk, sent] : sent_) {
    Worker& worker = workers_[sent.worker];
    const auto cost = sent.piece->batch->cost->get_s();
    if (worker.state != State::ready || !cost) {
      continue;
    }
    const double expected_s = sent.ahead_s + *cost * static_cast<double>(sent.piece->count) /
                                                 static_cast<double>(worker.introduction.threads);
    const double passed_s = awake_.get_s() - sent.at_awake_s;
    if (passed_s > worker.patience * (settings_.patience_s + kTolerance * expected_s)) {
      worker.state = State::late;
      notices_.push_back(
          fmt::format("warning: {} has not answered for {:.1f} s, where {:.3g} s were to be "
                      "expected; others do its work",
                      name_worker(sent.worker), passed_s, expected_s));
      reassign(sent.worker);
    }
  }
  if (awake_.get_s() - last_alive_s_ > kAliveEvery_s) {
    last_alive_s_ = awake_.get_s();
    for (std::size_t rank = 1; rank < workers_.size(); ++rank) {
      outgoing_.emplace_back(rank, make_rank_message(RankMessage::alive));
    }
  }
}

std::string Coordinator::name_worker(std::size_t rank) const {
  const std::string& host = workers_[rank].introduction.host;
  return host.empty() ? fmt::format("rank {}", rank)
                      : fmt::format("rank {} on {}", rank, sanitize(host));
}

bool end_workers(Links& links, double patience_s) {
  constexpr microseconds kPause{500};
  for (std::size_t rank = 1; rank < links.size(); ++rank) {
    links.send(rank, make_rank_message(RankMessage::end));
  }
  std::size_t missing = links.size() - 1;
  const auto start = std::chrono::steady_clock::now();
  while (missing > 0 && to_seconds(std::chrono::steady_clock::now() - start) < patience_s) {
    const auto message = links.receive();
    if (!message) {
      std::this_thread::sleep_for(kPause);
    } else if (message->bytes == make_rank_message(RankMessage::bye)) {
      --missing;
    }
  }
  const auto last = missing == 0 ? RankMessage::finalize : RankMessage::leave;
  for (std::size_t rank = 1; rank < links.size(); ++rank) {
    links.send(rank, make_rank_message(last));
  }
  return missing == 0;
}

}  // namespace armwright
