#include "mechanics/momentum_sweep_instances.hpp"

namespace stirsph {
template void MechanicsIn<AxisymmetricSwirl>::sweep_momentum(std::size_t, std::size_t, const MomentumConstants&,
                                                             double* const*, double*, double*);
}  // namespace stirsph
