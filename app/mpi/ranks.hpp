#pragma once

#include <mpi.h>

#include <cstddef>
#include <string>
#include <vector>

namespace pingvox::app {

/// The processes that mpirun has started, and what they tell each other. An error of MPI ends all of them.
class Ranks {
 public:
  Ranks(int* argc, char*** argv);
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;
  ~Ranks();

  std::size_t own() const { return own_; }  ///< number of this one, the first is 0
  std::size_t count() const { return count_; }

  /// The text of the first rank.
  std::string broadcast(std::string text) const;
  /// The texts of all, by their number.
  std::vector<std::string> gather_for_all(const std::string& text) const;
  void send(const std::string& text, std::size_t to) const;
  std::string receive(std::size_t from) const;
  /// Each number from 0 on is taken by one rank.
  std::size_t take_number() const;
  /// Ends all ranks, also those that wait for this one.
  [[noreturn]] void end_all(int status) const;
  /// Lets MPI answer other ranks while this one computes.
  void make_progress() const;

 private:
  std::size_t own_ = 0, count_ = 1;
  long* next_ = nullptr;  ///< of the first rank: the number that is taken next
  MPI_Win window_ = MPI_WIN_NULL;
};

}  // namespace pingvox::app
