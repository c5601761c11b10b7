#include "mechanics/smooth_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/tensor.hpp"
#include "particles/field_names.hpp"

namespace stirsph {
namespace {

constexpr std::int64_t most_nodes = 8000;  ///< half a megabyte of sums to add over ranks, a millisecond of work

/// Calls visit(offset) for all neighbours along the axes.
template <class Visit>
void along_axes(int dim, Visit&& visit) {
  for (int d = 0; d < dim; ++d)
    for (int side : {-1, 1}) {
      std::array<std::int64_t, 3> offset{};
      offset[d] = side;
      visit(offset);
    }
}

/// Calls visit(offset) for the whole neighbourhood, the centre included.
template <class Visit>
void all_around(int dim, Visit&& visit) {
  for (std::int64_t z = dim > 2 ? -1 : 0; z <= (dim > 2 ? 1 : 0); ++z)
    for (std::int64_t y = -1; y <= 1; ++y)
      for (std::int64_t x = -1; x <= 1; ++x) visit(std::array<std::int64_t, 3>{x, y, z});
}

std::array<std::int64_t, 3> sum(const std::array<std::int64_t, 3>& a, const std::array<std::int64_t, 3>& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

}  // namespace

SmoothMotion::SmoothMotion(const Comm& comm, const ParticleSet& particles, const Domain& domain, double cell)
    : dim_(domain.dim), domain_(domain) {
  place_grid(comm, particles, cell);
  std::vector<Node> nodes = measure(comm, particles);
  extrapolate(nodes);
  velocity_.resize(nodes.size());
  for (std::size_t n = 0; n < nodes.size(); ++n)
    if (nodes[n].known) velocity_[n] = nodes[n].velocity;
  find_compression(comm);
}

void SmoothMotion::place_grid(const Comm& comm, const ParticleSet& particles, double cell) {
  std::vector<double> extent(6, -std::numeric_limits<double>::max());  // of -x and x
  for (int d = 0; d < dim_; ++d) {
    const auto x = particles.component(field::position, d).first(particles.owned());
    for (const double value : x) {
      extent[d] = std::max(extent[d], -value);
      extent[3 + d] = std::max(extent[3 + d], value);
    }
  }
  comm.max_in_place(extent);
  std::array<double, 3> length{};
  for (int d = 0; d < dim_; ++d) {
    low_[d] = domain_.periodic[d] ? domain_.low[d] : -extent[d];
    length[d] = domain_.periodic[d] ? domain_.length(d) : std::max(0.0, extent[3 + d] + extent[d]);
  }
  for (double size = cell;; size *= 1.1) {
    double count = 1;
    for (int d = 0; d < dim_; ++d) count *= std::floor(length[d] / size) + 2;
    if (count > static_cast<double>(most_nodes)) continue;
    for (int d = 0; d < dim_; ++d) {
      cells_[d] = std::max<std::int64_t>(1, static_cast<std::int64_t>(length[d] / size));
      nodes_[d] = cells_[d] + (domain_.periodic[d] ? 0 : 1);
      size_[d] = std::max(length[d] / static_cast<double>(cells_[d]), size);
    }
    for (int d = 0; d < dim_; ++d)
      if (domain_.periodic[d]) size_[d] = length[d] / static_cast<double>(cells_[d]);
    return;
  }
}

SmoothMotion::Index SmoothMotion::unfold(std::int64_t number, const Index& count) const {
  return {number % count[0], number / count[0] % count[1], number / (count[0] * count[1])};
}

std::int64_t SmoothMotion::number(Index at) const {
  for (int d = 0; d < dim_; ++d) {
    if (domain_.periodic[d])
      at[d] = (at[d] + nodes_[d]) % nodes_[d];
    else if (at[d] < 0 || at[d] >= nodes_[d])
      return -1;
  }
  return (at[2] * nodes_[1] + at[1]) * nodes_[0] + at[0];
}

SmoothMotion::Corners SmoothMotion::corners(const std::array<double, 3>& x) const {
  Corners result;
  Index cell{};
  for (int d = 0; d < dim_; ++d) {
    const double along = (x[d] - low_[d]) / size_[d];
    cell[d] = std::clamp<std::int64_t>(static_cast<std::int64_t>(along), 0, cells_[d] - 1);
    result.part[d] = along - static_cast<double>(cell[d]);
  }
  std::array<std::array<std::int64_t, 2>, 3> step{};  // contribution of each side to the number of the node
  std::int64_t stride = 1;
  for (int d = 0; d < dim_; ++d) {
    step[d][0] = stride * cell[d];
    step[d][1] = stride * (cell[d] + 1 == nodes_[d] ? 0 : cell[d] + 1);
    stride *= nodes_[d];
  }
  for (int corner = 0; corner < 1 << dim_; ++corner) {
    result.node[corner] = 0;
    result.weight[corner] = 1;
    for (int d = 0; d < dim_; ++d) {
      const int side = corner >> d & 1;
      result.node[corner] += step[d][side];
      result.weight[corner] *= side ? result.part[d] : 1 - result.part[d];
    }
  }
  return result;
}

/// Weighted means, each at the mean place of its particles, and by differences of neighbours the gradient there.
std::vector<SmoothMotion::Node> SmoothMotion::measure(const Comm& comm, const ParticleSet& particles) {
  const std::int64_t count = nodes_[0] * nodes_[1] * nodes_[2];
  std::vector<double> sums(count * std::tuple_size_v<Sums>, 0.0);
  std::array<const double*, 3> x{}, v{};
  for (int d = 0; d < dim_; ++d) {
    x[d] = particles.component(field::position, d).data();
    v[d] = particles.component(field::velocity, particles.layout().axes[d]).data();
  }
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    std::array<double, 3> position{};
    Sums own{1};
    for (int d = 0; d < dim_; ++d) {
      position[d] = x[d][i];
      own[4 + d] = v[d][i];
    }
    const Corners around = corners(position);
    for (int corner = 0; corner < 1 << dim_; ++corner) {
      double* const sum = &sums[around.node[corner] * std::tuple_size_v<Sums>];
      // A particle in the face of its cell counts on the far side as well: its cell must show as occupied.
      const double weight = std::max(around.weight[corner], 1e-12);
      for (int d = 0; d < dim_; ++d) own[1 + d] = (around.part[d] - (corner >> d & 1)) * size_[d];  // from the node
      for (std::size_t k = 0; k < own.size(); ++k) sum[k] += weight * own[k];
    }
  }
  comm.sum_in_place(sums);

  std::vector<Node> nodes(count);
  touched_.resize(count);
  const auto weight = [&](std::int64_t n) { return n < 0 ? 0.0 : sums[n * std::tuple_size_v<Sums>]; };
  for (std::int64_t n = 0; n < count; ++n) {
    touched_[n] = weight(n) > 0;
    if (!touched_[n]) continue;
    // A node with less than the weight of a particle takes the value of its neighbours, if there are any.
    bool better = false;
    along_axes(dim_, [&](const Index& offset) { better |= weight(number(sum(unfold(n, nodes_), offset))) >= 1; });
    if (weight(n) < 1 && better) continue;
    nodes[n].known = true;
    for (int d = 0; d < dim_; ++d) {
      nodes[n].at[d] = sums[n * std::tuple_size_v<Sums> + 1 + d] / weight(n);  // from the node
      nodes[n].velocity[d] = sums[n * std::tuple_size_v<Sums> + 4 + d] / weight(n);
    }
  }
  for (std::int64_t n = 0; n < count; ++n)
    if (nodes[n].known) find_gradient(nodes, n);
  for (Node& node : nodes)
    for (int a = 0; a < dim_; ++a)
      for (int b = 0; b < dim_; ++b) node.velocity[a] -= node.gradient[a][b] * node.at[b];
  return nodes;
}

/// Least squares over the neighbours along the axes.
void SmoothMotion::find_gradient(std::vector<Node>& nodes, std::int64_t n) const {
  Matrix<3> moment;
  std::array<std::array<double, 3>, 3> slope{};
  const Index centre = unfold(n, nodes_);
  along_axes(dim_, [&](const Index& offset) {
    const std::int64_t other = number(sum(centre, offset));
    if (other < 0 || other == n || !nodes[other].known) return;
    std::array<double, 3> d{};
    for (int a = 0; a < dim_; ++a)
      d[a] = static_cast<double>(offset[a]) * size_[a] + nodes[other].at[a] - nodes[n].at[a];
    for (int a = 0; a < dim_; ++a)
      for (int b = 0; b < dim_; ++b) {
        moment(a, b) += d[a] * d[b];
        slope[a][b] += (nodes[other].velocity[a] - nodes[n].velocity[a]) * d[b];
      }
  });
  double trace = 0;
  for (int d = 0; d < dim_; ++d) trace += moment(d, d);
  if (trace == 0) return;
  // Where a direction has no neighbours its slope is zero, and so is that of the solution with a little on the
  // diagonal.
  for (int d = 0; d < 3; ++d) moment(d, d) += d < dim_ ? 1e-6 * trace : trace;
  const Matrix<3> solve = inverse(moment);
  for (int a = 0; a < dim_; ++a)
    for (int b = 0; b < dim_; ++b)
      for (int c = 0; c < dim_; ++c) nodes[n].gradient[a][b] += slope[a][c] * solve(c, b);
}

/// Two layers of nodes around the known ones: mean of what the neighbours' gradients say.
void SmoothMotion::extrapolate(std::vector<Node>& nodes) const {
  for (int layer = 0; layer < 2; ++layer) {
    const std::vector<Node> before = nodes;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      if (before[n].known) continue;
      Node mean;
      double count = 0;
      all_around(dim_, [&](const Index& offset) {
        const std::int64_t m = number(sum(unfold(static_cast<std::int64_t>(n), nodes_), offset));
        if (m < 0 || !before[m].known) return;
        count += 1;
        for (int a = 0; a < dim_; ++a) {
          mean.velocity[a] += before[m].velocity[a];
          for (int b = 0; b < dim_; ++b) {
            mean.velocity[a] -= before[m].gradient[a][b] * static_cast<double>(offset[b]) * size_[b];
            mean.gradient[a][b] += before[m].gradient[a][b];
          }
        }
      });
      if (count == 0) continue;
      nodes[n].known = true;
      for (int a = 0; a < dim_; ++a) {
        nodes[n].velocity[a] = mean.velocity[a] / count;
        for (int b = 0; b < dim_; ++b) nodes[n].gradient[a][b] = mean.gradient[a][b] / count;
      }
    }
  }
}

void SmoothMotion::find_compression(const Comm& comm) {
  const std::int64_t count = cells_[0] * cells_[1] * cells_[2];
  const auto occupied = [&](Index cell) {
    for (int d = 0; d < dim_; ++d) {
      if (domain_.periodic[d])
        cell[d] = (cell[d] + cells_[d]) % cells_[d];
      else if (cell[d] < 0 || cell[d] >= cells_[d])
        return false;
    }
    for (int corner = 0; corner < 1 << dim_; ++corner)
      if (!touched_[number(sum(cell, {corner & 1, corner >> 1 & 1, corner >> 2 & 1}))]) return false;
    return true;
  };
  // Every rank has the whole grid and looks at its share.
  const std::int64_t first = count * comm.rank() / comm.size(), last = count * (comm.rank() + 1) / comm.size();
  for (std::int64_t c = first; c < last; ++c) {
    const Index cell = unfold(c, cells_);
    bool near = false;
    all_around(dim_, [&](const Index& offset) { near = near || occupied(sum(cell, offset)); });
    if (near) compression_ = std::max(compression_, compression_in(cell));
  }
  compression_ = comm.max(compression_);
}

/// Minus the least eigenvalue of the rate of deformation D at the corners. For N eigenvalues of mean m it is at least
/// m - sqrt((N-1)/N) |D - m I|, with equality in uniaxial compression.
double SmoothMotion::compression_in(const Index& cell) const {
  double worst = 0;
  for (int corner = 0; corner < 1 << dim_; ++corner) {
    const Index at = sum(cell, {corner & 1, corner >> 1 & 1, corner >> 2 & 1});
    const auto& here = velocity_[number(at)];
    double gradient[3][3] = {};
    for (int b = 0; b < dim_; ++b) {
      Index across = at;
      const int side = corner >> b & 1;
      across[b] += side ? -1 : 1;
      const auto& there = velocity_[number(across)];
      for (int a = 0; a < dim_; ++a) gradient[a][b] = (side ? here[a] - there[a] : there[a] - here[a]) / size_[b];
    }
    double mean = 0, square = 0;
    for (int a = 0; a < dim_; ++a) mean += gradient[a][a] / dim_;
    for (int a = 0; a < dim_; ++a)
      for (int b = 0; b < dim_; ++b) {
        const double rate = 0.5 * (gradient[a][b] + gradient[b][a]) - (a == b ? mean : 0.0);
        square += rate * rate;
      }
    worst = std::max(worst, std::sqrt(square * (dim_ - 1) / dim_) - mean);
  }
  return worst;
}

double SmoothMotion::distance() const {
  double least = std::numeric_limits<double>::infinity();
  for (int d = 0; d < dim_; ++d)
    if (cells_[d] > (domain_.periodic[d] ? 3 : 2)) least = std::min(least, size_[d]);
  return 2 * least;
}

void SmoothMotion::fill(ParticleSet& particles) const {
  std::array<const double*, 3> x{};
  std::array<double*, 3> v{};
  for (int d = 0; d < dim_; ++d) {
    x[d] = particles.component(field::position, d).data();
    v[d] = particles.component(field::smooth_velocity, d).data();
  }
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    std::array<double, 3> position{}, sum{};
    for (int d = 0; d < dim_; ++d) position[d] = x[d][i];
    const Corners around = corners(position);
    for (int corner = 0; corner < 1 << dim_; ++corner)
      for (int d = 0; d < dim_; ++d) sum[d] += around.weight[corner] * velocity_[around.node[corner]][d];
    for (int d = 0; d < dim_; ++d) v[d][i] = sum[d];
  }
}

}  // namespace stirsph
