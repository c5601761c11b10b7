/// Constants of the conduction operator on a simple cubic (square) lattice: bulk factor, kernel sum, surface
/// resistance.
#include <algorithm>
#include <cmath>
#include <vector>

#include "thermal/heat_solver.hpp"

namespace stirsph {
namespace {

/// The lattice seen as planes normal to a wall, in units of the spacing: per plane distance d the kernel sum and the
/// pair conductance (unit conductivity, before any normalisation).
struct Planes {
  std::vector<double> kernel_sum, conductance;
  int reach() const { return static_cast<int>(conductance.size()) - 1; }
  double bulk_sum() const {
    double sum = kernel_sum[0];
    for (int d = 1; d <= reach(); ++d) sum += 2 * kernel_sum[d];
    return sum;
  }
  /// M_xx = sum V x^2 (-W'/r): the conductivity of the lattice over the true one.
  double bulk_factor() const {
    double sum = 0;
    for (int d = 1; d <= reach(); ++d) sum += d * d * conductance[d];
    return sum;
  }
};

Planes project(const Kernel& kernel, int dim, double h) {
  return std::visit(
      [&]<class K>(const K&) {
        const int n = static_cast<int>(std::ceil(K::support * h));
        Planes planes{std::vector<double>(n + 1), std::vector<double>(n + 1)};
        for (int d = 0; d <= n; ++d)
          for (int y = -n; y <= n; ++y)
            for (int z = dim == 2 ? 0 : -n; z <= (dim == 2 ? 0 : n); ++z) {
              const double r = std::sqrt(double(d * d + y * y + z * z));
              planes.kernel_sum[d] += kernel_value<K>(r, h, dim);
              if (r > 0) planes.conductance[d] -= 2 * kernel_slope<K>(r, h, dim) / r;
            }
        return planes;
      },
      kernel);
}

}  // namespace

double lattice_conduction_factor(const Kernel& kernel, int dim, double h_over_dx) {
  return project(kernel, dim, h_over_dx).bulk_factor();
}

double lattice_kernel_sum(const Kernel& kernel, int dim, double h_over_dx) {
  return project(kernel, dim, h_over_dx).bulk_sum();
}

double lattice_surface_resistance(const Kernel& kernel, int dim, double h_over_dx) {
  const Planes planes = project(kernel, dim, h_over_dx);
  const int reach = planes.reach();
  const double factor = planes.bulk_factor(), bulk = planes.bulk_sum();

  // A half-space of layers 0 .. n-1 with surface correction s at its first layers; behind it the linear bulk profile
  // T = -p (unit flux, unit conductivity) is imposed. The disturbance decays within a few layers.
  const int n = 40 + 8 * reach;
  std::vector<double> s(n + reach, 1.0);
  for (int p = 0; p < reach; ++p) {
    double sum = planes.kernel_sum[0];
    for (int d = 1; d <= reach; ++d) sum += planes.kernel_sum[d] * (p >= d ? 2 : 1);
    s[p] = bulk / sum;
  }
  // Unknown: the excess e over the bulk profile. Its source is the unit flux at layer 0 less what the profile takes.
  std::vector<double> a(std::size_t(n) * n, 0.0), e(n, 0.0);
  e[0] = 1;
  for (int p = 0; p < n; ++p)
    for (int q = std::max(0, p - reach); q <= p + reach; ++q) {
      if (q == p) continue;
      const double g = planes.conductance[std::abs(p - q)] / factor * 0.5 * (s[p] + s[q]);
      a[std::size_t(p) * n + p] += g;
      if (q < n) a[std::size_t(p) * n + q] -= g;
      e[p] -= g * (q - p);
    }
  // Banded Gauss elimination; the matrix is positive definite, so no pivoting.
  for (int p = 0; p < n; ++p)
    for (int i = p + 1; i < std::min(n, p + reach + 1); ++i) {
      const double f = a[std::size_t(i) * n + p] / a[std::size_t(p) * n + p];
      for (int q = p; q < std::min(n, p + reach + 1); ++q) a[std::size_t(i) * n + q] -= f * a[std::size_t(p) * n + q];
      e[i] -= f * e[p];
    }
  for (int p = n; p-- > 0;) {
    for (int q = p + 1; q < std::min(n, p + reach + 1); ++q) e[p] -= a[std::size_t(p) * n + q] * e[q];
    e[p] /= a[std::size_t(p) * n + p];
  }
  return e[0];
}

}  // namespace stirsph
