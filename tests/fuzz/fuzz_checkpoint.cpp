/// libFuzzer over the bytes of a checkpoint: any file either gives particles and a state or is refused with an IoError.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "checkpoint_input.hpp"

namespace {

using namespace stirsph;

/// `fuzz_checkpoint --write-seed FILE`: a small checkpoint to start from.
void write_seed(const std::string& path) {
  ParticleSet particles = fuzz::particles_with_fields();
  particles.resize_owned(3);
  write_checkpoint(Comm(), path, particles, {{{"clock", {0.25, 1e-6}}}, {{"scene", "title = \"seed\""}}});
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  fuzz::start_mpi();
  if (*argc == 3 && std::strcmp((*argv)[1], "--write-seed") == 0) {
    write_seed((*argv)[2]);
    MPI_Finalize();
    std::_Exit(0);
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::FILE* const file = std::fopen(fuzz::file_name().c_str(), "wb");
  if (!file || std::fwrite(data, 1, size, file) != size || std::fclose(file) != 0) std::abort();
  fuzz::read_or_refuse();
  return 0;
}
