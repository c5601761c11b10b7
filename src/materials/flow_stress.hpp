/// Flow stress models: J2 radial return against sigma_y(plastic strain, rate, temperature).
///
/// A model is one file (a struct with `keyword`, `declare`, a constructor from Parameters and `evaluate`) and one line
/// in registry.cpp. The return map is written once over the model, so its inner loop is inlined; virtual calls are per
/// batch.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "base/error.hpp"

namespace stirsph {

/// Flow stress and its slopes at one state.
struct FlowPoint {
  double stress;        ///< Pa
  double strain_slope;  ///< Pa, d stress / d plastic strain
  double rate_slope;    ///< Pa s, d stress / d plastic strain rate
};

/// A batch of particles of one material. Arrays have `count` entries.
struct FlowBatch {
  int count = 0;
  const double* trial = nullptr;           ///< Pa, equivalent trial stress sqrt(3/2 s:s)
  const double* plastic_strain = nullptr;  ///< at the start of the step
  const double* temperature = nullptr;     ///< K
  double dt = 0;                           ///< s
  double shear_modulus = 0;                ///< Pa
  double* increment = nullptr;             ///< out: plastic strain increment, >= 0
  double* flow_stress = nullptr;           ///< out: Pa, sigma_y after the step
  const double* previous_rate = nullptr;   ///< 1/s, plastic strain rate of the last step, a first guess; or null
};

class FlowStress {
 public:
  virtual ~FlowStress() = default;
  /// Solves trial - 3 G x = sigma_y(eps_p + x, x/dt, T) for x >= 0. Returns the number of iterations over the batch.
  virtual long return_map(const FlowBatch& batch) const = 0;
  /// sigma_y [Pa] at a plastic strain, plastic strain rate [1/s] and temperature [K].
  virtual double value(double plastic_strain, double rate, double temperature) const = 0;
};

template <class Model>
class FlowStressOf final : public FlowStress {
 public:
  explicit FlowStressOf(Model model) : model_(std::move(model)) {}

  long return_map(const FlowBatch& b) const override {
    long iterations = 0;
    for (int k = 0; k < b.count; ++k) {
      const double still = model_.evaluate(b.plastic_strain[k], 0.0, b.temperature[k]).stress;
      b.increment[k] = 0;
      b.flow_stress[k] = still;
      if (b.trial[k] > still) iterations += plastic(b, k, still);
    }
    return iterations;
  }
  double value(double plastic_strain, double rate, double temperature) const override {
    return model_.evaluate(plastic_strain, rate, temperature).stress;
  }

 private:
  /// Newton's method kept inside a shrinking bracket: the flow stress has a kink at the reference rate and an infinite
  /// slope at zero plastic strain, where plain Newton may leave the interval.
  long plastic(const FlowBatch& b, int k, double still) const {
    const double three_g = 3 * b.shear_modulus, trial = b.trial[k];
    constexpr double vanishing = 1e-290;  // below it the strain powers underflow
    double low = 0, high = (trial - std::min(still, trial)) / three_g, x = high;
    if (b.previous_rate)  // flow is steady more often than not
      if (const double guess = b.previous_rate[k] * b.dt; guess > 0 && guess < high) x = guess;
    for (long iteration = 1; iteration <= 200; ++iteration) {
      const FlowPoint f = model_.evaluate(b.plastic_strain[k] + x, x / b.dt, b.temperature[k]);
      const double residual = trial - three_g * x - f.stress;
      (residual > 0 ? low : high) = x;
      if (std::abs(residual) <= 1e-13 * trial || high - low <= 1e-15 * high || high < vanishing) {
        b.increment[k] = x;
        b.flow_stress[k] = trial - three_g * x;
        return iteration;
      }
      const double newton = x + residual / (three_g + f.strain_slope + f.rate_slope / b.dt);
      // Towards zero by decades: with a small hardening exponent a hair of overstress needs a strain of 1e-100 or less.
      x = newton > low && newton < high ? newton : low > 0 ? 0.5 * (low + high) : 1e-3 * high;
    }
    throw BlowUp("the return map did not converge (trial stress " + std::to_string(trial) + " Pa, plastic strain " +
                 std::to_string(b.plastic_strain[k]) + ", temperature " + std::to_string(b.temperature[k]) + " K)");
  }

  Model model_;
};

}  // namespace stirsph
