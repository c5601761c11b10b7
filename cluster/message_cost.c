/* What messages cost between the ranks of this job: the network figures of scaling_model.py.
   mpicc -O2 message_cost.c -o message_cost && mpirun -n 64 ./message_cost
   Prints one line: latency_s= (8 bytes, one way, first to last rank) bandwidth_B_per_s= (1 MB, the same way)
   copy_B_per_s= (packing scattered doubles into a message) allreduce_s= (24 doubles, all ranks). */
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>

enum { large = 1 << 17, gathered = 1 << 15, votes = 24 };

/* Median of an odd number of times [s]: other work on the machine must not decide the result. */
static int ascending(const void* a, const void* b) {
  const double x = *(const double*)a, y = *(const double*)b;
  return (x > y) - (x < y);
}
static double median(double* times, int n) {
  qsort(times, n, sizeof(double), ascending);
  return times[n / 2];
}

/* One way, first rank to last and back halved [s]. */
static double one_way(double* buffer, int count, int repeats, int rank, int last) {
  double times[21];
  for (int block = 0; block < 21; ++block) {
    const double start = MPI_Wtime();
    for (int k = 0; k < repeats; ++k) {
      if (rank == 0) {
        MPI_Send(buffer, count, MPI_DOUBLE, last, 1, MPI_COMM_WORLD);
        MPI_Recv(buffer, count, MPI_DOUBLE, last, 2, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
      } else if (rank == last) {
        MPI_Recv(buffer, count, MPI_DOUBLE, 0, 1, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
        MPI_Send(buffer, count, MPI_DOUBLE, 0, 2, MPI_COMM_WORLD);
      }
    }
    times[block] = (MPI_Wtime() - start) / (2 * repeats);
  }
  return median(times, 21);
}

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  int rank, size;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  if (size < 2) {
    fprintf(stderr, "message_cost: started on %d rank; at least 2 are needed (mpirun -n 2 ...)\n", size);
    MPI_Finalize();
    return 2;
  }
  double* buffer = malloc(large * sizeof(double));
  double* field = malloc(8 * gathered * sizeof(double));
  int* index = malloc(gathered * sizeof(int));
  if (!buffer || !field || !index) MPI_Abort(MPI_COMM_WORLD, 1);
  for (int k = 0; k < large; ++k) buffer[k] = k;
  for (int k = 0; k < 8 * gathered; ++k) field[k] = k;
  for (int k = 0; k < gathered; ++k) index[k] = 8 * k + k % 5;

  one_way(buffer, 1, 20, rank, size - 1); /* connections are made at the first message */
  const double latency = one_way(buffer, 1, 200, rank, size - 1);
  const double transfer = one_way(buffer, large, 4, rank, size - 1);

  double packing[21], voting[21], sums[votes] = {0};
  for (int block = 0; block < 21; ++block) {
    double start = MPI_Wtime();
    for (int k = 0; k < gathered; ++k) buffer[k] = field[index[k]];
    packing[block] = MPI_Wtime() - start;
    MPI_Barrier(MPI_COMM_WORLD);
    start = MPI_Wtime();
    for (int k = 0; k < 100; ++k) MPI_Allreduce(MPI_IN_PLACE, sums, votes, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
    voting[block] = (MPI_Wtime() - start) / 100;
  }
  if (rank == 0)
    printf("latency_s=%.3g bandwidth_B_per_s=%.4g copy_B_per_s=%.4g allreduce_s=%.3g ranks=%d\n", latency,
           large * sizeof(double) / (transfer - latency), gathered * sizeof(double) / median(packing, 21),
           median(voting, 21), size);
  free(buffer);
  free(field);
  free(index);
  MPI_Finalize();
  return 0;
}
