/// A smooth velocity field close to the particles' own, with a bound on how fast it can bring two points together. Pair
/// lists age by the motion relative to it, so that a turning or flowing billet does not use up the skin.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "base/comm.hpp"
#include "parallel/domain.hpp"
#include "particles/particle_set.hpp"

namespace stirsph {

/// Velocities at the nodes of a coarse grid over all particles, multilinear in the cells between them. Its gradient
/// within a cell is a convex combination of the gradients at the corners of the cell, and the least eigenvalue of the
/// rate of deformation is concave: the corners bound it.
class SmoothMotion {
 public:
  /// Means of the particles' velocities around the nodes of cells at least `cell` [m] wide. Collective.
  SmoothMotion(const Comm& comm, const ParticleSet& particles, const Domain& domain, double cell);

  /// Evaluates the field [m/s] at the positions of all owned particles into field::smooth_velocity.
  void fill(ParticleSet& particles) const;
  /// Two points closer than `distance()` approach each other at most with this rate [1/s] times their distance.
  double compression() const { return compression_; }
  /// Shortest edge of a cell, doubled [m]: the segment between two such particles stays in occupied cells and those
  /// around them, which are the ones `compression` looks at. Infinite when these are all cells.
  double distance() const;

 private:
  using Index = std::array<std::int64_t, 3>;
  /// Sums over particles with the weight of the node: weight, position, velocity.
  using Sums = std::array<double, 8>;
  struct Node {
    bool known = false;
    std::array<double, 3> at{}, velocity{};           ///< where the value was measured [m]; the value there
    std::array<std::array<double, 3>, 3> gradient{};  ///< of component a along b [1/s]
  };
  /// Corners of a cell as seen from a point in it; bit d of the corner's number says on which side it lies.
  struct Corners {
    std::array<std::int64_t, 8> node;
    std::array<double, 8> weight;
    std::array<double, 3> part{};  ///< place of the point in the cell, 0..1
  };

  void place_grid(const Comm& comm, const ParticleSet& particles, double cell);
  std::vector<Node> measure(const Comm& comm, const ParticleSet& particles);
  void find_gradient(std::vector<Node>& nodes, std::int64_t n) const;
  void extrapolate(std::vector<Node>& nodes) const;
  void find_compression(const Comm& comm);
  double compression_in(const Index& cell) const;

  Corners corners(const std::array<double, 3>& x) const;
  Index unfold(std::int64_t number, const Index& count) const;
  /// Number of a node; -1 outside the grid. Wraps around in periodic directions.
  std::int64_t number(Index at) const;

  int dim_;
  Domain domain_;
  std::array<double, 3> low_{}, size_{1, 1, 1};  ///< m
  Index cells_{1, 1, 1}, nodes_{1, 1, 1};
  std::vector<char> touched_;  ///< per node: some particle has weight there
  std::vector<std::array<double, 3>> velocity_;
  double compression_ = 0;
};

}  // namespace stirsph
