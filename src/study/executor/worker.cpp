#include "study/executor/worker.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <system_error>
#include <utility>

namespace armwright {
namespace {

using std::chrono::microseconds;
using WorkClock = std::chrono::steady_clock;

// The pause between two checks for messages while there is nothing to do. It is short at first and
// grows, because the next batch usually comes soon.
class IdlePause {
 public:
  void restart() { pause_ = kShortest; }
  microseconds next() {
    const microseconds pause = pause_;
    pause_ = std::min(pause_ + pause_ / 64, kLongest);
    return pause;
  }

 private:
  static constexpr microseconds kShortest{100}, kLongest{2000};
  microseconds pause_ = kShortest;
};

}  // namespace

// Jobs that the coordinator has sent together, and what has come of them so far.
struct Worker::Chunk {
  std::uint64_t number = 0;
  const Problem* problem = nullptr;
  ReceivedJobs received;
  std::size_t jobs_at_once = 1;
  std::vector<CaseOutcome> outcomes;
  std::size_t next = 0;     // the first job that no thread has taken yet
  std::size_t missing = 0;  // jobs whose outcomes are missing
  double busy_s = 0;        // of all threads together
  std::string failure;
};

Worker::Worker(MessageTransport& transport, std::vector<const Problem*> problems,
               WorkerIntroduction introduction, double silence_s)
    : transport_(transport), problems_(std::move(problems)), longest_silence_s_(silence_s) {
  try {
    while (introduction.failure.empty() && threads_.size() < introduction.threads) {
      threads_.emplace_back([this] { run_thread(); });
    }
  } catch (const std::system_error& error) {
    if (threads_.empty()) {
      introduction.failure = error.what();
    }
    introduction.threads = threads_.size();
  }
  transport_.send(0, make_rank_message(introduction));
}

Worker::~Worker() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  stop_.request(StopReason::terminated);
  has_work_.notify_all();
  for (std::thread& thread : threads_) {
    thread.join();
  }
}

Worker::End Worker::serve() {
  constexpr microseconds kBusyPause{1000};
  End end = End::abandoned;
  IdlePause idle;
  silence_.restart();
  while (silence_.get_s() < longest_silence_s_) {
    while (const auto message = transport_.receive()) {
      silence_.restart();
      idle.restart();
      if (handle_message(message->bytes, end)) {
        return end;
      }
    }
    std::unique_lock lock(mutex_);
    if (done_.empty()) {
      has_results_.wait_for(lock, under_way_ > 0 ? kBusyPause : idle.next());
    }
    lock.unlock();
    send_results();
    silence_.look();
  }
  return End::abandoned;
}

bool Worker::handle_message(const std::string& message, End& end) {
  PacketReader packet(message);
  switch (packet.get<RankMessage>()) {
    case RankMessage::chunk:
      add_chunk(packet);
      return false;
    case RankMessage::forget:
      problems_.at(packet.get<std::uint64_t>())->forget_cases();
      return false;
    case RankMessage::alive:
      return false;
    case RankMessage::end: {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
      waiting_.clear();
      stop_.request(StopReason::terminated);
      transport_.send(0, make_rank_message(RankMessage::bye));
      return false;
    }
    case RankMessage::finalize:
      end = End::finalize;
      return true;
    case RankMessage::leave:
      end = End::leave;
      return true;
    default:
      throw PacketError("the coordinator sent a message of a kind that it does not send");
  }
}

void Worker::add_chunk(PacketReader& packet) {
  auto chunk = std::make_shared<Chunk>();
  chunk->number = packet.get<std::uint64_t>();
  chunk->problem = problems_.at(packet.get<std::uint64_t>());
  get_jobs(packet, chunk->received);
  const auto& jobs = chunk->received.jobs;
  const bool jacobian = !jobs.empty() && jobs.front().jacobian;
  const BatchSize size =
      jacobian ? BatchSize{} : chunk->problem->batch_size(chunk->received.block.role);
  chunk->jobs_at_once = calc_chunk(size, jobs.size(), threads_.size());
  chunk->missing = jobs.size();
  chunk->outcomes.resize(jobs.size());
  const std::lock_guard lock(mutex_);
  ++under_way_;
  if (jobs.empty()) {
    done_.push_back(std::move(chunk));
    return;
  }
  waiting_.push_back(std::move(chunk));
  has_work_.notify_all();
}

void Worker::send_results() {
  while (true) {
    std::shared_ptr<Chunk> chunk;
    {
      const std::lock_guard lock(mutex_);
      if (done_.empty()) {
        return;
      }
      chunk = std::move(done_.front());
      done_.pop_front();
      --under_way_;
    }
    PacketWriter packet;
    if (!chunk->failure.empty()) {
      packet.put(RankMessage::failed);
      packet.put(std::string_view(chunk->failure));
    } else {
      packet.put(RankMessage::outcomes);
      packet.put(chunk->number);
      packet.put(chunk->busy_s /
                 static_cast<double>(std::max<std::size_t>(1, chunk->outcomes.size())));
      put_outcomes(packet, chunk->outcomes);
    }
    transport_.send(0, packet.bytes());
  }
}

void Worker::run_thread() {
  std::unique_lock lock(mutex_);
  while (true) {
    has_work_.wait(lock, [this] { return stopping_ || !waiting_.empty(); });
    if (stopping_) {
      return;
    }
    simulate_jobs(lock, waiting_.front());
  }
}

void Worker::simulate_jobs(std::unique_lock<std::mutex>& lock,
                           const std::shared_ptr<Chunk>& waiting) {
  const std::shared_ptr<Chunk> chunk = waiting;
  const std::size_t first = chunk->next;
  const std::size_t count = std::min(chunk->jobs_at_once, chunk->received.jobs.size() - first);
  chunk->next += count;
  if (chunk->next == chunk->received.jobs.size()) {
    waiting_.pop_front();
  }
  lock.unlock();
  std::optional<std::vector<CaseOutcome>> outcomes;
  std::string failure;
  const WorkClock::time_point start = WorkClock::now();
  try {
    outcomes = simulate_until(stop_, *chunk->problem,
                              std::span(chunk->received.jobs).subspan(first, count));
  } catch (const std::exception& error) {
    failure = error.what();
  }
  const std::chrono::duration<double> taken = WorkClock::now() - start;
  lock.lock();
  if (failure.empty() && !outcomes) {
    return;
  }
  if (failure.empty()) {
    std::ranges::move(*outcomes, chunk->outcomes.begin() + static_cast<std::ptrdiff_t>(first));
  } else {
    chunk->failure = failure;
  }
  chunk->busy_s += taken.count();
  chunk->missing -= count;
  if (chunk->missing == 0) {
    done_.push_back(chunk);
    has_results_.notify_one();
  }
}

}  // namespace armwright
