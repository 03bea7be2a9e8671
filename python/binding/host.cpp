#include "host.hpp"

#include <cmath>
#include <condition_variable>
#include <exception>
#include <utility>

namespace armwright::python {
namespace {

constexpr std::chrono::milliseconds kLookInterval{50};  // users do not notice this delay

py::tuple to_tuple(const Progress& progress) {
  const bool has_best = std::isfinite(progress.best_objective);
  return py::make_tuple(to_string(progress.phase), progress.done, progress.total, progress.replayed,
                        progress.generation,
                        has_best ? py::object(py::float_(progress.best_objective)) : py::none());
}

}  // namespace

py::object to_exception(const py::error_already_set& error) {
  if (error.trace()) {
    PyException_SetTraceback(error.value().ptr(), error.trace().ptr());
  }
  return error.value();
}

std::shared_ptr<py::object> share(py::object object) {
  return {new py::object(std::move(object)), [](py::object* last) {
            const py::gil_scoped_acquire gil;
            delete last;
          }};
}

Host::Host(py::object listener) : listener_(std::move(listener)) {
  stop_.set_lookout([this] { look_out(); });
}

void Host::limit_time(std::optional<double> limit_s) {
  if (limit_s) {
    stop_.set_deadline(StopSignal::Clock::now() +
                       std::chrono::duration_cast<StopSignal::Clock::duration>(
                           std::chrono::duration<double>(*limit_s)));
  }
}

void Host::on_progress(const Progress& progress) {
  const std::lock_guard lock(mutex_);
  progress_ = progress;
}

void Host::on_message(const std::string& message) {
  const std::lock_guard lock(mutex_);
  messages_.push_back(message);
}

void Host::look_out() {
  if (std::this_thread::get_id() != caller_) {
    return;
  }
  const auto now = Clock::now();
  if (now - last_look_ >= kLookInterval) {
    look();
    last_look_ = Clock::now();
  }
}

void Host::look() {
  const py::gil_scoped_acquire gil;
  if (!held_.is_none()) {
    return;
  }
  try {
    if (PyErr_CheckSignals() != 0) {
      throw py::error_already_set();
    }
    tell();
  } catch (const py::error_already_set& error) {
    hold(error);
  }
}

void Host::tell() {
  std::deque<std::string> messages;
  std::optional<Progress> progress;
  {
    const std::lock_guard lock(mutex_);
    std::swap(messages, messages_);
    std::swap(progress, progress_);
  }
  if (listener_.is_none()) {
    return;
  }
  for (const std::string& message : messages) {
    listener_(message, py::none());
  }
  if (progress) {
    listener_(py::none(), to_tuple(*progress));
  }
}

void Host::hold(const py::error_already_set& error) {
  if (held_.is_none()) {
    held_ = to_exception(error);
  }
  stop_.request(StopReason::interrupted);
}

void Host::raise_held() const {
  if (!held_.is_none()) {
    PyErr_SetObject(py::type::handle_of(held_).ptr(), held_.ptr());
    throw py::error_already_set();
  }
}

void Host::run(const std::function<void()>& work) {
  {
    const py::gil_scoped_release released;
    try {
      work();
    } catch (const WorkStopped&) {  // finish() throws the reason
    }
  }
  finish();
}

void Host::run_aside(const std::function<void()>& work) {
  {
    const py::gil_scoped_release released;
    std::mutex mutex;
    std::condition_variable ended;
    bool has_ended = false;
    std::exception_ptr failure;
    std::thread worker([&] {
      try {
        work();
      } catch (...) {
        failure = std::current_exception();
      }
      const std::lock_guard lock(mutex);
      has_ended = true;
      ended.notify_one();
    });
    for (std::unique_lock lock(mutex);
         !ended.wait_for(lock, kLookInterval, [&] { return has_ended; });) {
      lock.unlock();
      look();
      lock.lock();
    }
    worker.join();
    if (failure) {
      std::rethrow_exception(failure);
    }
  }
  finish();
}

void Host::finish() {
  raise_held();
  if (PyErr_CheckSignals() != 0) {
    throw py::error_already_set();
  }
  tell();
}

}  // namespace armwright::python
