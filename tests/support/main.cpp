/// GoogleTest under MPI: every rank runs every test, rank 0 reports, and a failure on any rank fails the run.
#include <gtest/gtest.h>
#include <mpi.h>

#include "base/comm.hpp"
#ifdef STIRSPH_TEST_PETSC
#include "thermal/petsc_session.hpp"
#endif
#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

int main(int argc, char** argv) {
  stirsph::skip_display_probes();
#ifdef __SANITIZE_ADDRESS__
  __lsan_disable();  // Open MPI loses memory in modules that it unloads at once, whose names no suppression knows
#endif
  MPI_Init(&argc, &argv);
#ifdef __SANITIZE_ADDRESS__
  __lsan_enable();
#endif
  int failed = 0;
  {
#ifdef STIRSPH_TEST_PETSC
    stirsph::PetscSession petsc;
#endif
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
    int local = RUN_ALL_TESTS();
#ifdef __SANITIZE_ADDRESS__
    // Before MPI_Finalize, as the rest of the modules are unloaded there.
    if (__lsan_do_recoverable_leak_check() != 0) local = 1;
#endif
    MPI_Allreduce(&local, &failed, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  }
  MPI_Finalize();
  return failed;
}
