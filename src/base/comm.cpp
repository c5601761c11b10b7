#include "base/comm.hpp"

#include <algorithm>
#include <cstdlib>
#include <numeric>

namespace stirsph {

void skip_display_probes() { setenv("HWLOC_COMPONENTS", "-gl", 0); }

void check_mpi(int status, const char* call) {
  if (status == MPI_SUCCESS) return;
  char text[MPI_MAX_ERROR_STRING];
  int length = 0;
  MPI_Error_string(status, text, &length);
  throw Error(ExitCode::Internal, std::string(call) + " failed: " + std::string(text, length));
}

namespace {
template <class T>
MPI_Datatype mpi_type();
template <>
MPI_Datatype mpi_type<double>() {
  return MPI_DOUBLE;
}
template <>
MPI_Datatype mpi_type<std::int64_t>() {
  return MPI_INT64_T;
}

template <class T>
std::vector<T> gather_varying(const Comm& comm, const std::vector<T>& local, bool on_all) {
  const int size = comm.size();
  std::vector<int> counts(size), offsets(size);
  const int count = static_cast<int>(local.size());
  check_mpi(MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, comm.handle()), "MPI_Allgather");
  std::exclusive_scan(counts.begin(), counts.end(), offsets.begin(), 0);
  std::vector<T> all(on_all || comm.is_root() ? offsets.back() + counts.back() : 0);
  if (on_all)
    check_mpi(MPI_Allgatherv(local.data(), count, mpi_type<T>(), all.data(), counts.data(), offsets.data(),
                             mpi_type<T>(), comm.handle()),
              "MPI_Allgatherv");
  else
    check_mpi(MPI_Gatherv(local.data(), count, mpi_type<T>(), all.data(), counts.data(), offsets.data(), mpi_type<T>(),
                          0, comm.handle()),
              "MPI_Gatherv");
  return all;
}

template <class T>
void broadcast_vector(const Comm& comm, std::vector<T>& values, int root) {
  std::int64_t count = static_cast<std::int64_t>(values.size());
  check_mpi(MPI_Bcast(&count, 1, MPI_INT64_T, root, comm.handle()), "MPI_Bcast");
  values.resize(count);
  check_mpi(MPI_Bcast(values.data(), static_cast<int>(count), mpi_type<T>(), root, comm.handle()), "MPI_Bcast");
}
}  // namespace

Comm::Comm(MPI_Comm handle) : handle_(handle) {
  check_mpi(MPI_Comm_rank(handle_, &rank_), "MPI_Comm_rank");
  check_mpi(MPI_Comm_size(handle_, &size_), "MPI_Comm_size");
}

double Comm::reduce(double local, MPI_Op op) const {
  double result = 0;
  check_mpi(MPI_Allreduce(&local, &result, 1, MPI_DOUBLE, op, handle_), "MPI_Allreduce");
  return result;
}

std::int64_t Comm::reduce(std::int64_t local, MPI_Op op) const {
  std::int64_t result = 0;
  check_mpi(MPI_Allreduce(&local, &result, 1, MPI_INT64_T, op, handle_), "MPI_Allreduce");
  return result;
}

void Comm::sum_in_place(std::vector<double>& values) const {
  check_mpi(MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM, handle_),
            "MPI_Allreduce");
}

void Comm::max_in_place(std::vector<double>& values) const {
  check_mpi(MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_MAX, handle_),
            "MPI_Allreduce");
}

std::int64_t Comm::exclusive_sum(std::int64_t local) const {
  std::int64_t before = 0;
  check_mpi(MPI_Exscan(&local, &before, 1, MPI_INT64_T, MPI_SUM, handle_), "MPI_Exscan");
  return rank_ == 0 ? 0 : before;
}

std::vector<double> Comm::all_gather(const std::vector<double>& local) const {
  return gather_varying(*this, local, true);
}
std::vector<std::int64_t> Comm::all_gather(const std::vector<std::int64_t>& local) const {
  return gather_varying(*this, local, true);
}
std::vector<double> Comm::gather(const std::vector<double>& local) const { return gather_varying(*this, local, false); }

std::vector<double> Comm::exchange(const std::vector<std::vector<double>>& outgoing) const {
  std::vector<int> send_counts(size_), send_offsets(size_), receive_counts(size_), receive_offsets(size_);
  std::vector<double> sent;
  for (int r = 0; r < size_; ++r) {
    send_counts[r] = static_cast<int>(outgoing[r].size());
    send_offsets[r] = static_cast<int>(sent.size());
    sent.insert(sent.end(), outgoing[r].begin(), outgoing[r].end());
  }
  check_mpi(MPI_Alltoall(send_counts.data(), 1, MPI_INT, receive_counts.data(), 1, MPI_INT, handle_), "MPI_Alltoall");
  std::exclusive_scan(receive_counts.begin(), receive_counts.end(), receive_offsets.begin(), 0);
  std::vector<double> received(static_cast<std::size_t>(receive_offsets.back() + receive_counts.back()));
  check_mpi(MPI_Alltoallv(sent.data(), send_counts.data(), send_offsets.data(), MPI_DOUBLE, received.data(),
                          receive_counts.data(), receive_offsets.data(), MPI_DOUBLE, handle_),
            "MPI_Alltoallv");
  return received;
}

std::string Comm::broadcast(const std::string& text, int root) const {
  std::int64_t length = static_cast<std::int64_t>(text.size());
  check_mpi(MPI_Bcast(&length, 1, MPI_INT64_T, root, handle_), "MPI_Bcast");
  std::string result = text;
  result.resize(length);
  check_mpi(MPI_Bcast(result.data(), static_cast<int>(length), MPI_CHAR, root, handle_), "MPI_Bcast");
  return result;
}

void Comm::broadcast(std::vector<std::int64_t>& values, int root) const { broadcast_vector(*this, values, root); }
void Comm::broadcast(std::vector<double>& values, int root) const { broadcast_vector(*this, values, root); }

void Comm::barrier() const { check_mpi(MPI_Barrier(handle_), "MPI_Barrier"); }

void Comm::throw_together(std::exception_ptr local) const {
  const std::int64_t culprit = min(std::int64_t(local ? rank_ : size_));
  if (culprit == size_) return;
  std::string message;
  std::vector<std::int64_t> code{static_cast<std::int64_t>(ExitCode::Internal)};
  if (culprit == rank_) {
    try {
      std::rethrow_exception(local);
    } catch (const Error& error) {
      message = error.what();
      code[0] = static_cast<std::int64_t>(error.code());
    } catch (const std::exception& error) {
      message = error.what();
    } catch (...) {
      message = "unknown exception";
    }
  }
  message = broadcast(message, static_cast<int>(culprit));
  broadcast(code, static_cast<int>(culprit));
  throw Error(static_cast<ExitCode>(code[0]), message);
}

}  // namespace stirsph
