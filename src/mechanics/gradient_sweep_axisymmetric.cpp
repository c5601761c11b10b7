#include "mechanics/gradient_sweep_instances.hpp"

namespace stirsph {
template void MechanicsIn<AxisymmetricSwirl>::sweep_gradient(const PairList&, std::size_t, std::size_t, std::size_t,
                                                             GradientBlock<AxisymmetricSwirl>&);
}  // namespace stirsph
