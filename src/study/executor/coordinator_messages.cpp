// The coordinator's exchange of messages with workers. All of it runs on one thread, which alone
// uses the transport.
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

constexpr double kAliveEvery_s = 10;  // workers wait far longer before they give up

double to_seconds(auto duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace

void Coordinator::run_transport() {
  Lock lock(mutex_);
  awake_.restart();
  while (!stopping_) {
    has_news_ = false;
    assign();
    auto outgoing = std::exchange(outgoing_, {});
    auto notices = std::exchange(notices_, {});
    lock.unlock();
    for (auto& [rank, message] : outgoing) {
      transport_.send(rank, std::move(message));
    }
    for (const std::string& notice : notices) {
      notify_(notice);
    }
    lock.lock();
    receive_messages(lock);
    awake_.look();
    check_late_workers();
    if (!stopping_ && !has_news_) {
      wake_communication_.wait_for(lock, calc_pause());
    }
  }
}

// Returns the longest pause that keeps no worker waiting for its next chunk.
microseconds Coordinator::calc_pause() const {
  constexpr microseconds kShortest{50}, kLongest{1000}, kIdle{20'000};
  if (sent_.empty()) {
    return kIdle;
  }
  const Clock::time_point now = Clock::now();
  microseconds pause = kLongest;
  for (std::size_t rank = 1; rank < workers_.size(); ++rank) {
    const RemoteWorker& worker = workers_[rank];
    if (worker.state == WorkerState::ready && worker.chunks > 0) {
      const auto expected = std::chrono::duration_cast<microseconds>(worker.free_at - now) /
                            (4 * static_cast<int>(worker.chunks));
      pause = std::min(pause, std::max(kShortest, expected));
    }
  }
  return pause;
}

// Sends chunks to the workers that are ready, one each per round, as long as a chunk saves time.
// With many ranks, most have enough chunks at any time, so the check of those must be cheap.
void Coordinator::assign() {
  const TeamSize team = calc_team();
  double left_here_s = calc_left_here_s();
  bool has_sent = std::ranges::any_of(
      batches_, [this](const auto& batch) { return batch->problem && count_untaken(*batch) > 0; });
  while (std::exchange(has_sent, false)) {
    for (std::size_t rank = 1; rank < workers_.size(); ++rank) {
      RemoteWorker& worker = workers_[rank];
      if (worker.state != WorkerState::ready || worker.chunks >= kChunksAhead) {
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
            plan_remote_chunk(batch->cases->chunk_size(), count_untaken(*batch), team,
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
  RemoteWorker& worker = workers_[rank];
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

// Handles at most kAtOnce messages: workers that have answered wait for their next chunk.
void Coordinator::receive_messages(Lock& lock) {
  constexpr int kAtOnce = 256;
  for (int taken = 0; taken < kAtOnce; ++taken) {
    lock.unlock();
    const auto message = transport_.receive();
    lock.lock();
    if (!message) {
      return;
    }
    has_news_ = true;
    try {
      handle_message(lock, *message);
    } catch (const PacketError& error) {
      exclude_worker(message->from, error.what());
    }
  }
}

void Coordinator::handle_message(Lock& lock, const MessageTransport::Message& message) {
  PacketReader packet(message.bytes);
  RemoteWorker& worker = workers_.at(message.from);
  if (worker.state == WorkerState::late) {
    worker.state = WorkerState::ready;
    worker.late_factor *= 2;
    notices_.push_back(fmt::format("{} answers again", name_worker(message.from)));
  }
  switch (packet.get<RankMessage>()) {
    case RankMessage::ready:
      admit_worker(message.from, get_introduction(packet));
      return;
    case RankMessage::outcomes:
      handle_outcomes(lock, message.from, packet);
      return;
    case RankMessage::failed:
      exclude_worker(message.from, packet.get_text());
      return;
    default:
      throw PacketError("it sent a message of a kind that workers do not send");
  }
}

void Coordinator::admit_worker(std::size_t rank, WorkerIntroduction introduction) {
  RemoteWorker& worker = workers_[rank];
  worker.introduction = std::move(introduction);
  if (!worker.introduction.failure.empty()) {
    exclude_worker(rank, worker.introduction.failure);
    return;
  }
  const auto differences = describe_differences(identity_, worker.introduction.identity);
  if (!differences.empty()) {
    exclude_worker(rank,
                   "it has another program or other problems (recorded: here, now: there):\n  " +
                       join(differences, "\n  "));
    return;
  }
  worker.state = WorkerState::ready;
  worker.free_at = worker.heard_at = Clock::now();
  // All ranks run the same code, except in the C library: that chooses code by the processor.
  if (!settings_.cpu.empty() && worker.introduction.cpu != settings_.cpu) {
    notices_.push_back(
        fmt::format("note: {} has another processor ({}; here: {}). The last bits of results may "
                    "then depend on which rank computes them; for the same bits every time use "
                    "machines of one kind",
                    name_worker(rank), sanitize(worker.introduction.cpu), settings_.cpu));
  }
}

void Coordinator::handle_outcomes(Lock& lock, std::size_t rank, PacketReader& packet) {
  const auto found = sent_.find(packet.get<std::uint64_t>());
  const auto pair_s = packet.get<double>();
  std::vector<CaseOutcome> outcomes = get_outcomes(packet);
  if (found == sent_.end() || found->second.worker != rank ||
      outcomes.size() != found->second.piece->count) {
    throw PacketError("it sent outcomes that it was not asked for");
  }
  const SentPiece sent = std::move(found->second);
  sent_.erase(found);
  RemoteWorker& worker = workers_[rank];
  const Clock::time_point now = Clock::now();
  worker.heard_at = now;
  --worker.chunks;
  if (worker.chunks == 0) {
    worker.free_at = now;
  }
  const auto pairs = static_cast<double>(sent.piece->count);
  if (sent.was_idle) {
    const double work_s = pair_s * pairs / static_cast<double>(worker.introduction.threads);
    worker.latency.add(std::max(0.0, to_seconds(now - sent.at) - work_s));
  }
  if (!sent.piece->batch->closed) {
    sent.piece->batch->cost->add(pair_s * pairs, sent.piece->count);
  }
  deliver(lock, sent.piece, std::move(outcomes));
}

void Coordinator::exclude_worker(std::size_t rank, const std::string& reason) {
  workers_[rank].state = WorkerState::excluded;
  reassign(rank);
  notices_.push_back(fmt::format("warning: {} cannot be used: {}", name_worker(rank), reason));
}

// Lets others simulate the pieces that the worker has not delivered.
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

void Coordinator::check_late_workers() {
  constexpr double kTolerance = 4;  // times the expected time
  // There may be thousands of chunks, so they are not checked at every turn.
  constexpr double kCheckEvery = 0.05;  // times late_after_s
  if (awake_.get_s() - last_check_s_ < kCheckEvery * settings_.late_after_s) {
    return;
  }
  last_check_s_ = awake_.get_s();
  for (auto& [chunk, sent] : sent_) {
    RemoteWorker& worker = workers_[sent.worker];
    const auto cost = sent.piece->batch->cost->get_s();
    if (worker.state != WorkerState::ready || !cost) {
      continue;
    }
    const double expected_s = sent.ahead_s + *cost * static_cast<double>(sent.piece->count) /
                                                 static_cast<double>(worker.introduction.threads);
    const double passed_s = awake_.get_s() - sent.at_awake_s;
    if (passed_s > worker.late_factor * (settings_.late_after_s + kTolerance * expected_s)) {
      worker.state = WorkerState::late;
      notices_.push_back(
          fmt::format("warning: {} has not answered for {:.1f} s, where {:.3g} s were "
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

bool end_workers(MessageTransport& transport, double timeout_s) {
  constexpr microseconds kPause{500};
  for (std::size_t rank = 1; rank < transport.size(); ++rank) {
    transport.send(rank, make_rank_message(RankMessage::end));
  }
  std::size_t missing = transport.size() - 1;
  const auto start = std::chrono::steady_clock::now();
  while (missing > 0 && to_seconds(std::chrono::steady_clock::now() - start) < timeout_s) {
    const auto message = transport.receive();
    if (!message) {
      std::this_thread::sleep_for(kPause);
    } else if (message->bytes == make_rank_message(RankMessage::bye)) {
      --missing;
    }
  }
  const auto last = missing == 0 ? RankMessage::finalize : RankMessage::leave;
  for (std::size_t rank = 1; rank < transport.size(); ++rank) {
    transport.send(rank, make_rank_message(last));
  }
  return missing == 0;
}

}  // namespace armwright
