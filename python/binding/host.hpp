// Connects a call from Python with long work in C++: Ctrl-C stops the work, and progress and
// messages reach Python. Both happen only on the thread that called. This code installs no signal
// handler: Python's own handler records the interruption, and the work checks for it whenever it
// checks the stop signal.
#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "base/stop_signal.hpp"
#include "study/run/run_observer.hpp"

namespace armwright::python {

namespace py = pybind11;

// Returns the exception itself, with its traceback.
py::object to_exception(const py::error_already_set& error);

// Returns a shared object that takes the GIL before it is destroyed, because threads without the GIL
// copy and destroy what refers to it.
std::shared_ptr<py::object> share(py::object object);

// An observer and a stop signal for one call from Python. The caller creates and destroys it with
// the GIL held.
class Host final : public RunObserver {
 public:
  // `listener` is None or a function. It is called as listener(message, None) or listener(None,
  // progress), where progress is the tuple (phase, done, total, replayed, generation, best). `best`
  // is None before the first objective.
  explicit Host(py::object listener);

  StopSignal& stop() { return stop_; }
  void limit_time(std::optional<double> limit_s);  // counted from this call

  // Any thread may call these. The listener hears of them at the next look().
  void on_progress(const Progress& progress) override;
  void on_message(const std::string& message) override;

  // Runs `work` without the GIL, then tells the listener the last messages. Throws what the work
  // throws; otherwise what Python raised meanwhile: KeyboardInterrupt, an exception of the
  // listener, or an exception of an optimizer that does not count as the optimizer's failure. The
  // work may end with WorkStopped after such an exception.
  void run(const std::function<void()>& work);
  // Does the same on a new thread, for work that does not check the stop signal on the thread that
  // called it.
  void run_aside(const std::function<void()>& work);

  // Needs the GIL. Keeps the first exception and requests a stop of the work. raise_held() throws
  // that exception again, if there is one.
  void hold(const py::error_already_set& error);
  void raise_held() const;

 private:
  using Clock = std::chrono::steady_clock;
  void look_out();  // calls look() if this is the caller's thread, but not too often
  void look();      // without the GIL: checks for signals and calls the listener
  void tell();      // with the GIL: calls the listener
  void finish();

  py::object listener_;
  StopSignal stop_;
  const std::thread::id caller_ = std::this_thread::get_id();
  Clock::time_point last_look_ = Clock::now();
  py::object held_ = py::none();  // an exception
  std::mutex mutex_;              // guards the members below
  std::deque<std::string> messages_;
  std::optional<Progress> progress_;
};

}  // namespace armwright::python
