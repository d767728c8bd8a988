#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <cstddef>
#include <exception>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "pingvox/result.hpp"

/// Errors, signals and the lock of the interpreter.
namespace pingvox::python {

namespace py = pybind11;

/// An error of the library on its way to Python, where it is a pingvox.Error.
class RaisedError final : public std::exception {
 public:
  explicit RaisedError(Error error) : error_(std::move(error)) {}
  const Error& error() const { return error_; }
  const char* what() const noexcept override { return error_.message.c_str(); }

 private:
  Error error_;
};

/// The value of a result; throws RaisedError where it is an error.
template <class T>
T value_of(Result<T> result) {
  if (!result) throw RaisedError(std::move(result.error()));
  if constexpr (!std::is_void_v<T>) return *std::move(result);
}

/// Throws pingvox.Error for what the caller got wrong.
[[noreturn]] void raise_usage(std::string message);

/// A message of the program or the library with the names of keyword arguments: "--nav-offset" becomes "nav_offset".
std::string with_keyword_names(std::string_view message);

/// A pingvox.Error.
py::object error_object(const Error& error);

/// Makes RaisedError the exception pingvox.Error.
void translate_errors();

/// Thrown through the library where Python code has raised an exception meanwhile, which is set in the interpreter.
/// Not a std::exception, as the library makes errors of those.
struct Interrupted {};

/// Calls `f` without the lock of the interpreter, so that other threads of Python go on.
template <class F>
auto without_lock(F&& f) {
  try {
    const py::gil_scoped_release release;
    return std::forward<F>(f)();
  } catch (const Interrupted&) {
    throw py::error_already_set();
  }
}

/// Lets Python handle signals (Ctrl-C) within a long call, and call back, at most every 50 ms.
class Interpreter {
 public:
  Interpreter() = default;
  /// @param callback  None, or called with what is done; has to outlive this
  explicit Interpreter(const py::object& callback) : callback_(callback.is_none() ? nullptr : &callback) {}

  /// Whether there was nothing for a while. Cheap.
  bool is_due() {
    constexpr auto kPause = std::chrono::milliseconds(50);
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < kPause) return false;
    last_ = now;
    return true;
  }
  /// REQUIRES the lock is not held. Throws Interrupted.
  template <class Done>
  void tell(Done done) {
    const py::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0) throw Interrupted();  // NOLINT(hicpp-exception-baseclass): see there
    if (callback_ == nullptr) return;
    try {
      (*callback_)(done);
    } catch (py::error_already_set& error) {
      error.restore();
      throw Interrupted();  // NOLINT(hicpp-exception-baseclass)
    }
  }

 private:
  const py::object* callback_ = nullptr;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// Signals within loops of many quick steps.
class SignalCheck {
 public:
  void operator()() {
    constexpr std::size_t kSteps = 1024;
    if (++steps_ % kSteps != 0 || !interpreter_.is_due()) return;
    interpreter_.tell(0);
  }

 private:
  Interpreter interpreter_;
  std::size_t steps_ = 0;
};

}  // namespace pingvox::python
