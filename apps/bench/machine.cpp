#include "bench/machine.hpp"

#include <algorithm>
#include <fstream>
#include <limits>

#include "base/simd.hpp"
#include "base/timer.hpp"
#include "particles/particle_set.hpp"

namespace stirsph::bench {
namespace {

constexpr int repeats = 5;

/// Enough independent chains to hide a latency of 4 cycles on 2 units, few enough for the 16 registers of AVX2.
constexpr int chains = 12;

volatile double sink;  // results go here, so that no work can be left out

/// Lane operations per second of `operation`, which maps a register to the next value of its chain.
template <class Operation>
double operation_rate(const Comm& comm, Operation operation) {
  const auto seconds_of = [&](long rounds) {
    Lanes chain[chains];
    for (int k = 0; k < chains; ++k) chain[k] = 1.0 + 1e-3 * k;
    const double start = wall_seconds();
    for (long round = 0; round < rounds; ++round)
      for (Lanes& value : chain) value = operation(value);
    const double seconds = wall_seconds() - start;
    Lanes sum = 0.0;
    for (const Lanes& value : chain) sum += value;
    sink = stdx::reduce(sum);
    return seconds;
  };
  long rounds = 10000;
  while (seconds_of(rounds) < 0.05) rounds *= 2;
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < repeats; ++k) {
    comm.barrier();
    least = std::min(least, seconds_of(rounds));
  }
  return static_cast<double>(rounds) * chains * lanes / least;
}

double triad_rate(const Comm& comm) {
  const std::size_t size = std::size_t(1) << 23;  // 64 MiB per array
  AlignedVector a(size, 0.0), b(size, 1.0), c(size, 2.0);
  const volatile double factor_source = 0.5;
  const double factor = factor_source;
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < repeats; ++k) {
    comm.barrier();
    const double start = wall_seconds();
    for (std::size_t i = 0; i < size; ++i) a[i] = b[i] + factor * c[i];
    least = std::min(least, wall_seconds() - start);
    sink = a[size / 2];
  }
  return 24.0 * static_cast<double>(size) / least;
}

}  // namespace

Processor processor() {
  Processor result{"unknown", "unknown", "unknown"};
  std::ifstream file("/proc/cpuinfo");
  std::string line;
  while (std::getline(file, line) && !line.empty()) {  // the first core's block ends with an empty line
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos || colon + 2 > line.size()) continue;
    const std::string name = line.substr(0, line.find_last_not_of(" \t", colon - 1) + 1);
    const std::string value = line.substr(colon + 2);
    if (name == "model name") result.model = value;
    if (name == "cpu family") result.family = value;
    if (name == "model") result.model_number = value;
  }
  return result;
}

MachineRates measure_machine(const Comm& comm) {
  // Known only at run time, so that nothing is computed in advance; the chains stay near 1.
  const volatile double factor_source = 0.999999, term_source = 1e-6;
  const Lanes factor = factor_source, term = term_source;
  MachineRates rates;
  rates.multiply_add = 2 * operation_rate(comm, [&](const Lanes& x) { return Lanes(x * factor + term); });
  rates.add = operation_rate(comm, [&](const Lanes& x) { return Lanes(x + term); });
  rates.divide = operation_rate(comm, [&](const Lanes& x) { return Lanes(factor / x); });
  rates.square_root = operation_rate(comm, [&](const Lanes& x) { return Lanes(sqrt(x)); });
  rates.triad = triad_rate(comm);
  for (double* rate : {&rates.multiply_add, &rates.add, &rates.divide, &rates.square_root, &rates.triad})
    *rate = comm.sum(*rate) / comm.size();
  return rates;
}

}  // namespace stirsph::bench
