#include "mechanics/gradient_sweep_instances.hpp"

namespace stirsph {
template void MechanicsIn<Cartesian3>::sweep_gradient(const PairList&, std::size_t, std::size_t, std::size_t,
                                                      GradientBlock<Cartesian3>&);
}  // namespace stirsph
