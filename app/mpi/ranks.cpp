#include "ranks.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>

namespace pingvox::app {
namespace {

/// MPI counts bytes by int.
constexpr std::size_t kMaxMessage = std::size_t{1} << 30;
constexpr int kTag = 1;

int rank_of(std::size_t number) {
  return static_cast<int>(number);
}

/// Calls `move` for each part of a text that fits into a message.
template <class Move>
void in_parts(std::string& text, Move&& move) {
  for (std::size_t at = 0; at < text.size(); at += kMaxMessage) {
    move(text.data() + at, static_cast<int>(std::min(kMaxMessage, text.size() - at)));
  }
}

}  // namespace

Ranks::Ranks(int* argc, char*** argv) {
  MPI_Init(argc, argv);
  int own = 0, count = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &own);
  MPI_Comm_size(MPI_COMM_WORLD, &count);
  own_ = static_cast<std::size_t>(own);
  count_ = static_cast<std::size_t>(count);
  const MPI_Aint bytes = own_ == 0 ? MPI_Aint{sizeof(long)} : MPI_Aint{0};
  MPI_Win_allocate(bytes, sizeof(long), MPI_INFO_NULL, MPI_COMM_WORLD, static_cast<void*>(&next_), &window_);
  if (own_ == 0) *next_ = 0;
  MPI_Barrier(MPI_COMM_WORLD);
  MPI_Win_lock_all(0, window_);
}

Ranks::~Ranks() {
  MPI_Win_unlock_all(window_);
  MPI_Win_free(&window_);
  MPI_Finalize();
}

std::string Ranks::broadcast(std::string text) const {
  std::uint64_t size = text.size();
  MPI_Bcast(&size, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD);
  text.resize(size);
  in_parts(text, [](char* part, int bytes) { MPI_Bcast(part, bytes, MPI_BYTE, 0, MPI_COMM_WORLD); });
  return text;
}

std::vector<std::string> Ranks::gather_for_all(const std::string& text) const {
  std::vector<std::string> texts(count_);
  for (std::size_t from = 0; from < count_; ++from) {
    std::uint64_t size = text.size();
    MPI_Bcast(&size, 1, MPI_UINT64_T, rank_of(from), MPI_COMM_WORLD);
    std::string& its = texts[from];
    its = text;
    its.resize(size);
    in_parts(its, [&](char* part, int bytes) { MPI_Bcast(part, bytes, MPI_BYTE, rank_of(from), MPI_COMM_WORLD); });
  }
  return texts;
}

void Ranks::send(const std::string& text, std::size_t to) const {
  const std::uint64_t size = text.size();
  MPI_Send(&size, 1, MPI_UINT64_T, rank_of(to), kTag, MPI_COMM_WORLD);
  std::string part_of = text;
  in_parts(part_of, [&](char* part, int bytes) { MPI_Send(part, bytes, MPI_BYTE, rank_of(to), kTag, MPI_COMM_WORLD); });
}

std::string Ranks::receive(std::size_t from) const {
  std::uint64_t size = 0;
  MPI_Recv(&size, 1, MPI_UINT64_T, rank_of(from), kTag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  std::string text(size, '\0');
  in_parts(text, [&](char* part, int bytes) {
    MPI_Recv(part, bytes, MPI_BYTE, rank_of(from), kTag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  });
  return text;
}

std::size_t Ranks::take_number() const {
  const long one = 1;
  long taken = 0;
  MPI_Fetch_and_op(&one, &taken, MPI_LONG, 0, 0, MPI_SUM, window_);
  MPI_Win_flush(0, window_);
  return static_cast<std::size_t>(taken);
}

void Ranks::end_all(int status) const {
  MPI_Abort(MPI_COMM_WORLD, status);
  std::abort();
}

void Ranks::make_progress() const {
  int is_there = 0;
  MPI_Iprobe(MPI_ANY_SOURCE, kTag, MPI_COMM_WORLD, &is_there, MPI_STATUS_IGNORE);
}

}  // namespace pingvox::app
