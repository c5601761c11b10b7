/// GoogleTest under MPI: every rank runs every test, rank 0 reports, and a failure on any rank fails the run.
#include <gtest/gtest.h>
#include <mpi.h>

#include "base/comm.hpp"
#include "thermal/petsc_session.hpp"

int main(int argc, char** argv) {
  stirsph::skip_display_probes();
  MPI_Init(&argc, &argv);
  int failed = 0;
  {
    stirsph::PetscSession petsc;
    ::testing::InitGoogleTest(&argc, argv);
    int rank = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    auto& listeners = ::testing::UnitTest::GetInstance()->listeners();
    if (rank != 0 && !::testing::GTEST_FLAG(list_tests)) {
      // Failures of other ranks must be seen; their successes must not clutter the report.
      class FailuresOnly : public ::testing::EmptyTestEventListener {
        void OnTestPartResult(const ::testing::TestPartResult& result) override {
          if (result.failed())
            fprintf(stderr, "%s:%d: %s\n", result.file_name(), result.line_number(), result.message());
        }
      };
      delete listeners.Release(listeners.default_result_printer());
      listeners.Append(new FailuresOnly);
    }
    const int local = RUN_ALL_TESTS();
    MPI_Allreduce(&local, &failed, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  }
  MPI_Finalize();
  return failed;
}
