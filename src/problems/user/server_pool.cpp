#include "problems/user/server_pool.hpp"

#include <unistd.h>

#include <condition_variable>
#include <deque>
#include <future>
#include <thread>
#include <utility>

#include "process/stop_scope.hpp"

namespace armwright {

// Starts servers on a thread of its own. The kernel kills a server's process when the thread that
// started it ends, and the threads that simulate may end before the pool.
class ServerPool::Launcher {
 public:
  using Task = std::packaged_task<std::unique_ptr<CaseServer>()>;

  Launcher() : thread_([this] { work(); }) {}
  ~Launcher() {
    {
      const std::lock_guard lock(mutex_);
      is_ending_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }
  Launcher(const Launcher&) = delete;
  Launcher& operator=(const Launcher&) = delete;

  std::unique_ptr<CaseServer> run(const std::function<std::unique_ptr<CaseServer>()>& start) {
    Task task([&start, stop = get_work_stop()] {
      const StopScope scope(stop);  // the work of the thread that asks
      return start();
    });
    auto started = task.get_future();
    {
      const std::lock_guard lock(mutex_);
      tasks_.push_back(std::move(task));
    }
    changed_.notify_all();
    return started.get();
  }

 private:
  void work() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [&] { return is_ending_ || !tasks_.empty(); });
      if (tasks_.empty()) {
        return;
      }
      Task task = std::move(tasks_.front());
      tasks_.pop_front();
      lock.unlock();
      task();
      lock.lock();
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Task> tasks_;
  bool is_ending_ = false;
  std::thread thread_;
};

ServerPool::ServerPool(std::function<std::unique_ptr<CaseServer>()> start)
    : start_(std::move(start)) {}

ServerPool::~ServerPool() {
  disown_inherited();
  idle_.clear();  // before the launcher, whose end would kill them
}

void ServerPool::disown_inherited() {
  if (owner_ == getpid()) {
    return;
  }
  owner_ = getpid();
  for (std::unique_ptr<CaseServer>& server : idle_) {
    static_cast<void>(server.release());  // the parent's: ending it here would kill it there
  }
  idle_.clear();
  static_cast<void>(launcher_.release());  // its thread does not exist here
}

std::unique_ptr<CaseServer> ServerPool::take(bool is_new) {
  Launcher* launcher = nullptr;
  {
    const std::lock_guard lock(mutex_);
    disown_inherited();
    if (!is_new && !idle_.empty()) {
      auto server = std::move(idle_.back());
      idle_.pop_back();
      return server;
    }
    if (!launcher_) {
      launcher_ = std::make_unique<Launcher>();
    }
    launcher = launcher_.get();
  }
  return launcher->run(start_);
}

void ServerPool::give_back(std::unique_ptr<CaseServer> server) {
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(server));
}

}  // namespace armwright
