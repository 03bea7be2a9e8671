#include "study/executor/coordinator.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

namespace armwright {

Coordinator::Coordinator(MessageTransport& transport, std::vector<const Problem*> problems,
                         std::string identity, CoordinatorSettings settings, Notify notify)
    : transport_(transport),
      problems_(std::move(problems)),
      identity_(std::move(identity)),
      settings_(settings),
      notify_(std::move(notify)),
      workers_(transport.size()) {
  communication_ = std::thread([this] { run_transport(); });
  try {
    while (helpers_.size() + 1 < settings_.threads) {
      helpers_.emplace_back([this] { run_helper(); });
    }
  } catch (const std::system_error&) {
    // With fewer threads the results are the same, but take longer.
  }
}

Coordinator::~Coordinator() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  wake_communication_.notify_all();
  for (std::thread& helper : helpers_) {
    helper.join();
  }
  communication_.join();
}

void Coordinator::run(const CaseBatch& cases, StopSignal& stop) {
  constexpr std::chrono::milliseconds kCheckForStop{20};
  if (cases.size() == 0) {
    return;
  }
  const auto batch = std::make_shared<Batch>();
  batch->cases = &cases;
  batch->stop = &stop;
  batch->left = cases.size();
  const auto known = std::ranges::find(problems_, &cases.problem());
  if (known != problems_.end()) {
    batch->problem = static_cast<std::uint64_t>(known - problems_.begin());
  }
  Lock lock(mutex_);
  batch->cost = &costs_[{&cases.problem(), cases.block().role, cases.extras().jacobian}];
  batches_.push_back(batch);
  has_news_ = true;
  wake_communication_.notify_one();
  if (!helpers_.empty() || batches_.size() > 1) {
    changed_.notify_all();
  }
  while (true) {
    if (stop.requested()) {
      batch->closed = true;
    }
    if (batch->is_over()) {
      break;
    }
    if (busy_until_.size() < settings_.threads) {
      if (const PiecePointer piece = take_local_piece(batch)) {
        simulate_piece(lock, piece);
        continue;
      }
    }
    changed_.wait_for(lock, kCheckForStop);
  }
  batch->closed = true;
  batches_.remove(batch);
  if (batch->failure) {
    std::rethrow_exception(batch->failure);
  }
}

void Coordinator::forget(const Problem& problem) {
  const auto known = std::ranges::find(problems_, &problem);
  problem.forget_cases();
  if (known == problems_.end()) {
    return;
  }
  const std::lock_guard lock(mutex_);
  for (std::size_t rank = 1; rank < workers_.size(); ++rank) {
    if (workers_[rank].state == WorkerState::ready) {
      PacketWriter packet;
      packet.put(RankMessage::forget);
      packet.put(static_cast<std::uint64_t>(known - problems_.begin()));
      outgoing_.emplace_back(rank, packet.bytes());
    }
  }
}

bool Coordinator::expects_workers() const {
  const std::lock_guard lock(mutex_);
  return std::any_of(workers_.begin() + 1, workers_.end(), [](const RemoteWorker& worker) {
    return worker.state == WorkerState::unknown;
  });
}

std::size_t Coordinator::count_untaken(const Batch& batch) const {
  if (batch.closed) {
    return 0;
  }
  std::size_t pairs = batch.cases->size() - batch.next;
  for (const PiecePointer& piece : batch.again) {
    pairs += piece->delivered ? 0 : piece->count;
  }
  return pairs;
}

// Returns how long the threads of this process would take for all pairs that are not taken yet, as
// far as costs are known. The time begins when one of them is free, and is at least that of one
// pair.
double Coordinator::calc_left_here_s() const {
  double seconds = 0, longest_s = 0;
  for (const auto& batch : batches_) {
    if (const std::size_t pairs = count_untaken(*batch); pairs > 0) {
      const double pair_s = batch->cost->get_s().value_or(0);
      seconds += static_cast<double>(pairs) * pair_s;
      longest_s = std::max(longest_s, pair_s);
    }
  }
  seconds = std::max(seconds / static_cast<double>(settings_.threads), longest_s);
  if (busy_until_.size() < settings_.threads) {
    return seconds;
  }
  const auto until_free = *std::ranges::min_element(busy_until_) - Clock::now();
  return seconds + std::max(0.0, std::chrono::duration<double>(until_free).count());
}

TeamSize Coordinator::calc_team() const {
  TeamSize team{.here = settings_.threads};
  for (const RemoteWorker& worker : workers_) {
    if (worker.state == WorkerState::ready) {
      team.elsewhere += worker.introduction.threads;
      ++team.workers;
    }
  }
  return team;
}

// Pieces of late workers come first, unchanged; then a new piece of at most `count` pairs.
Coordinator::PiecePointer Coordinator::take_piece(const std::shared_ptr<Batch>& batch,
                                                  std::size_t count) {
  while (!batch->again.empty()) {
    PiecePointer piece = std::move(batch->again.front());
    batch->again.pop_front();
    if (!piece->delivered) {
      return piece;
    }
  }
  count = std::min(count, batch->cases->size() - batch->next);
  if (count == 0) {
    return nullptr;
  }
  auto piece = std::make_shared<Piece>(Piece{.batch = batch, .first = batch->next, .count = count});
  batch->next += count;
  return piece;
}

Coordinator::PiecePointer Coordinator::take_local_piece(const std::shared_ptr<Batch>& batch) {
  if (batch->closed) {
    return nullptr;
  }
  return take_piece(batch, plan_local_chunk(batch->cases->chunk_size(), count_untaken(*batch),
                                            calc_team(), batch->cost->get_s()));
}

void Coordinator::simulate_piece(Lock& lock, const PiecePointer& piece) {
  Batch& batch = *piece->batch;
  ++batch.active;
  const std::chrono::duration<double> expected(batch.cost->get_s().value_or(0) *
                                               static_cast<double>(piece->count));
  const auto until = busy_until_.insert(
      busy_until_.end(), Clock::now() + std::chrono::duration_cast<Clock::duration>(expected));
  lock.unlock();
  std::optional<std::vector<CaseOutcome>> outcomes;
  std::exception_ptr failure;
  const Clock::time_point start = Clock::now();
  try {
    const auto jobs = batch.cases->make_jobs(piece->first, piece->count);
    outcomes = simulate_until(*batch.stop, batch.cases->problem(), jobs);
  } catch (...) {
    failure = std::current_exception();
  }
  const std::chrono::duration<double> taken = Clock::now() - start;
  lock.lock();
  if (failure) {
    batch.fail(failure);
  } else if (outcomes) {
    batch.cost->add(taken.count(), piece->count);
    deliver(lock, piece, *std::move(outcomes));
  } else {
    batch.closed = true;
  }
  busy_until_.erase(until);
  --batch.active;
  // A caller may wait for the end of this batch, or of another batch for a free thread.
  if (batches_.size() > 1 || batch.is_over()) {
    changed_.notify_all();
  }
}

// The first outcomes to arrive count; later ones for the same pairs are the same and are dropped.
void Coordinator::deliver(Lock& lock, const PiecePointer& piece,
                          std::vector<CaseOutcome> outcomes) {
  Batch& batch = *piece->batch;
  if (piece->delivered || batch.closed) {
    return;
  }
  piece->delivered = true;
  ++batch.active;
  lock.unlock();
  std::exception_ptr failure;
  try {
    batch.cases->deliver(piece->first, std::move(outcomes));
  } catch (...) {
    failure = std::current_exception();
  }
  lock.lock();
  if (failure) {
    batch.fail(failure);
  }
  batch.left -= piece->count;
  --batch.active;
  if (batch.is_over()) {
    changed_.notify_all();
  }
}

void Coordinator::run_helper() {
  Lock lock(mutex_);
  while (!stopping_) {
    PiecePointer piece;
    for (auto batch = batches_.begin(); batch != batches_.end() && !piece; ++batch) {
      if (busy_until_.size() < settings_.threads && !(*batch)->stop->requested()) {
        piece = take_local_piece(*batch);
      }
    }
    if (piece) {
      simulate_piece(lock, piece);
    } else {
      changed_.wait(lock);
    }
  }
}

}  // namespace armwright
