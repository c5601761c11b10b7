#include "mechanics/neighbourhood.hpp"

#include <algorithm>
#include <cmath>

#include "base/simd.hpp"
#include "mechanics/smooth_motion.hpp"
#include "neighbours/cluster_order.hpp"
#include "particles/field_names.hpp"

namespace stirsph {

Neighbourhood::Neighbourhood(Comm comm, Domain domain, double skin)
    : comm_(comm), domain_(domain), skin_(skin), decomposition_(comm), halo_(comm) {}

void Neighbourhood::add_fields(ParticleSet& particles) {
  for (const FieldInfo* info :
       {&field::id, &field::body, &field::material, &field::mass, &field::position, &field::position_at_list_build,
        &field::smooth_velocity, &field::smoothing_length, &field::volume})
    particles.add(*info);
}

void Neighbourhood::rebuild(ParticleSet& particles, double support, bool repartition, std::span<const double> costs) {
  reach_ = support + skin_;
  const CellTable cells = decomposition_.redistribute(particles, domain_, reach_, repartition, costs);
  particles.reorder(cluster_order(particles));
  for (int d = 0; d < domain_.dim; ++d) {
    const auto from = particles.component(field::position, d);
    std::copy(from.begin(), from.end(), particles.component(field::position_at_list_build, d).begin());
  }
  age_ = 0;
  if (particles.has(field::velocity)) {
    const SmoothMotion smooth(comm_, particles, domain_, reach_);
    smooth.fill(particles);
    compression_ = smooth.compression();
    distance_ = smooth.distance();
  }
  halo_.build(particles, cells, reach_);
  pairs_.build(particles, reach_);
  rebuilds_ += 1;
}

void Neighbourhood::restore(ParticleSet& particles, const std::vector<double>& state) {
  reach_ = state[0];
  age_ = state[1];
  compression_ = state[2];
  distance_ = state[3];
  std::vector<AlignedVector> now(domain_.dim);
  for (int d = 0; d < domain_.dim; ++d) {
    auto x = particles.component(field::position, d);
    const auto built = particles.component(field::position_at_list_build, d);
    now[d].assign(x.begin(), x.begin() + particles.owned());
    std::copy(built.begin(), built.begin() + particles.owned(), x.begin());
  }
  const CellTable cells(comm_, particles, domain_, reach_);
  halo_.build(particles, cells, reach_);
  pairs_.build(particles, reach_);
  for (int d = 0; d < domain_.dim; ++d)
    std::copy(now[d].begin(), now[d].end(), particles.component(field::position, d).begin());
  halo_.exchange(particles, Halo::Kinematic);
}

namespace {

/// Largest squares, lane by lane.
template <class T>
struct LargestSquares {
  T deviation = 0.0, relative_speed = 0.0, displacement = 0.0, speed = 0.0, acceleration = 0.0, extent = 0.0,
    speed_sum = 0.0, turning = 0.0;

  void raise(T& largest, const T& value) { largest = select(value > largest, value, largest); }
  void visit(int dim, const std::array<T, 3>& x, const std::array<T, 3>& moved, const std::array<T, 3>& smooth,
             const std::array<T, 3>& v, const std::array<T, 3>& a, double age) {
    T squares[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    for (int d = 0; d < dim; ++d) {
      const T deviated = moved[d] - age * smooth[d], relative = v[d] - smooth[d];
      squares[0] += deviated * deviated;
      squares[1] += relative * relative;
      squares[2] += moved[d] * moved[d];
      squares[3] += v[d] * v[d];
      squares[4] += a[d] * a[d];
      squares[5] += x[d] * x[d];
    }
    raise(deviation, squares[0]);
    raise(relative_speed, squares[1]);
    raise(displacement, squares[2]);
    raise(speed, squares[3]);
    raise(acceleration, squares[4]);
    raise(extent, squares[5]);
    speed_sum += squares[3];
  }
  /// Of the centripetal acceleration on a circle around the axis.
  void visit_circle(const std::array<T, 3>& x, const std::array<T, 3>& v, double core) {
    const T moment = x[0] * v[1] - x[1] * v[0], r2 = x[0] * x[0] + x[1] * x[1], least = core * core;
    const T spin = moment / select(r2 > least, r2, least);
    raise(turning, spin * spin * (v[0] * v[0] + v[1] * v[1]));
  }
};

}  // namespace

ListMotion Neighbourhood::motion(const ParticleSet& particles, const Inertia& inertia) const {
  const bool circles = domain_.dim == 3 && !inertia.swirl;
  std::array<const double*, 3> x{}, built{}, smooth{}, v{}, a{};
  for (int d = 0; d < domain_.dim; ++d) {
    x[d] = particles.component(field::position, d).data();
    built[d] = particles.component(field::position_at_list_build, d).data();
    smooth[d] = particles.component(field::smooth_velocity, d).data();
    v[d] = particles.component(field::velocity, particles.layout().axes[d]).data();
    a[d] = particles.component(field::acceleration, particles.layout().axes[d]).data();
  }
  const auto visit = [&]<class T>(LargestSquares<T>& largest, std::size_t i, auto&& load) {
    std::array<T, 3> x_here{}, moved{}, smooth_here{}, v_here{}, a_here{};
    for (int d = 0; d < domain_.dim; ++d) {
      x_here[d] = load(x[d] + i);
      moved[d] = x_here[d] - load(built[d] + i);
      smooth_here[d] = load(smooth[d] + i);
      v_here[d] = load(v[d] + i);
      a_here[d] = load(a[d] + i);
    }
    largest.visit(domain_.dim, x_here, moved, smooth_here, v_here, a_here, age_);
    if (circles) largest.visit_circle(x_here, v_here, inertia.core);
  };
  LargestSquares<Lanes> wide;
  LargestSquares<double> all;
  std::size_t i = 0;
  for (; i + lanes <= particles.owned(); i += lanes)
    visit(wide, i, [](const double* from) { return Lanes(from, stdx::element_aligned); });
  for (; i < particles.owned(); ++i) visit(all, i, [](const double* from) { return *from; });
  ListMotion motion;
  const auto largest = [](const Lanes& lane, double rest) { return std::sqrt(std::max(stdx::hmax(lane), rest)); };
  motion.deviation = largest(wide.deviation, all.deviation);
  motion.relative_speed = largest(wide.relative_speed, all.relative_speed);
  motion.displacement = largest(wide.displacement, all.displacement);
  motion.speed = largest(wide.speed, all.speed);
  motion.acceleration = largest(wide.acceleration, all.acceleration) + largest(wide.turning, all.turning);
  motion.extent = largest(wide.extent, all.extent);
  motion.finite = std::isfinite(stdx::reduce(wide.speed_sum) + all.speed_sum);
  return motion;
}

bool Neighbourhood::holds(const ListMotion& motion, double dt) const {
  const double support = reach_ - skin_;
  const double kick = 0.5 * dt * motion.acceleration;
  const double deviation = motion.deviation + dt * (motion.relative_speed + kick);
  const double displacement = motion.displacement + dt * (motion.speed + kick);
  if (reach_ - 2 * displacement >= support) return true;
  // Particles are put back into a periodic domain when the list is built and must not leave it far: a rigid body there
  // may end at the border. At an axis of symmetry the smooth motion says nothing of the images.
  if (domain_.any_images()) return false;
  const double squeezed = 1 - 2 * (age_ + dt) * compression_;
  return squeezed > 0 && reach_ * std::sqrt(squeezed) - 2 * deviation >= support &&
         distance_ - 2 * displacement >= support;
}

}  // namespace stirsph
