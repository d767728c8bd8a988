#pragma once

#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "pingvox/result.hpp"

namespace pingvox {

/// The files that a run records to. A run that fails to start removes them: they would block the next one.
class Recordings {
 public:
  /// @param sonar  the sonar's log, beside which the others are; nullopt: nothing is recorded
  explicit Recordings(std::optional<std::filesystem::path> sonar) : sonar_(std::move(sonar)) {}
  Recordings(const Recordings&) = delete;
  Recordings& operator=(const Recordings&) = delete;
  /// Removes what was created, unless it is kept.
  ~Recordings();

  const std::optional<std::filesystem::path>& sonar() const { return sonar_; }

  /// @param path  nullopt: nothing is recorded
  /// @param date  further arguments of Recorder::create
  template <class Recorder, class... Date>
  Result<std::optional<Recorder>> create(const std::optional<std::filesystem::path>& path, Date... date) {
    if (!path) return std::nullopt;
    Result<Recorder> recorder = Recorder::create(path->string(), date...);
    if (!recorder) return tl::unexpected(recorder.error());
    created_.push_back(*path);
    return std::optional<Recorder>(*std::move(recorder));
  }

  /// The run begins. @return the files
  std::vector<std::filesystem::path> keep() { return std::exchange(created_, {}); }

 private:
  std::optional<std::filesystem::path> sonar_;
  std::vector<std::filesystem::path> created_;
};

}  // namespace pingvox
