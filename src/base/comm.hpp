/// A checked, thin wrapper over an MPI communicator: the only calls the rest of the code makes outside parallel/.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <exception>
#include <string>
#include <vector>

#include "base/error.hpp"

namespace stirsph {

/// To be called by a program before MPI_Init. Keeps hwloc (used by Open MPI) from looking for graphics cards through
/// the X displays :0 to :9: without a name service for "localhost" that costs seconds at every start. HWLOC_COMPONENTS
/// in the environment overrules it.
void skip_display_probes();

/// Throws Error(Internal) when an MPI call did not succeed.
void check_mpi(int status, const char* call);

/// A communicator with the few collectives the code needs. Copies share the MPI handle; nothing is freed here.
class Comm {
 public:
  explicit Comm(MPI_Comm handle = MPI_COMM_WORLD);

  MPI_Comm handle() const { return handle_; }
  int rank() const { return rank_; }
  int size() const { return size_; }
  bool is_root() const { return rank_ == 0; }

  double sum(double local) const { return reduce(local, MPI_SUM); }
  double min(double local) const { return reduce(local, MPI_MIN); }
  double max(double local) const { return reduce(local, MPI_MAX); }
  std::int64_t sum(std::int64_t local) const { return reduce(local, MPI_SUM); }
  std::int64_t min(std::int64_t local) const { return reduce(local, MPI_MIN); }
  std::int64_t max(std::int64_t local) const { return reduce(local, MPI_MAX); }
  bool any(bool local) const { return reduce(std::int64_t(local), MPI_MAX) != 0; }
  /// Element-wise sum over ranks, in place, in rank order of the MPI library.
  void sum_in_place(std::vector<double>& values) const;
  void max_in_place(std::vector<double>& values) const;
  /// Sum over all lower ranks; 0 on rank 0.
  std::int64_t exclusive_sum(std::int64_t local) const;

  /// Concatenation of every rank's values in rank order, on all ranks.
  std::vector<double> all_gather(const std::vector<double>& local) const;
  std::vector<std::int64_t> all_gather(const std::vector<std::int64_t>& local) const;
  /// The same on the root only; empty elsewhere.
  std::vector<double> gather(const std::vector<double>& local) const;
  /// Sends `outgoing[r]` to rank r and returns what the ranks sent to this one, in rank order.
  std::vector<double> exchange(const std::vector<std::vector<double>>& outgoing) const;

  std::string broadcast(const std::string& text, int root = 0) const;
  void broadcast(std::vector<std::int64_t>& values, int root = 0) const;
  void broadcast(std::vector<double>& values, int root = 0) const;

  void barrier() const;

  /// Collective. If any rank passes an exception, all ranks throw an Error with the message and the exit code of the
  /// lowest failing rank; otherwise nothing happens. Turns a failure of one rank into a stop of all, without a hang.
  void throw_together(std::exception_ptr local) const;

  /// Runs `work` on this rank and then agrees: all ranks leave normally, or all throw the same Error. Collective;
  /// `work` itself must not contain collectives that a throwing rank would miss.
  template <class Work>
  void together(Work&& work) const {
    std::exception_ptr failure;
    try {
      work();
    } catch (...) {
      failure = std::current_exception();
    }
    throw_together(failure);
  }

 private:
  double reduce(double local, MPI_Op op) const;
  std::int64_t reduce(std::int64_t local, MPI_Op op) const;

  MPI_Comm handle_;
  int rank_ = 0;
  int size_ = 1;
};

}  // namespace stirsph
