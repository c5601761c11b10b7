/// Flow stress models: J2 radial return against sigma_y(plastic strain, rate, temperature).
///
/// A model is one file (a struct with `keyword`, `declare`, a constructor from Parameters and `evaluate`) and one line
/// in registry.cpp. The return map is written once over the model, so its inner loop is inlined; virtual calls are per
/// batch.
#pragma once

#include <limits>
#include <memory>
#include <string>

#include "base/error.hpp"
#include "base/simd.hpp"

namespace stirsph {

/// Flow stress and its slopes at one state, or at one in each lane.
template <class T>
struct FlowPoint {
  T stress;        ///< Pa
  T strain_slope;  ///< Pa, d stress / d plastic strain
  T rate_slope;    ///< Pa s, d stress / d plastic strain rate
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
  const double* rate_factor = nullptr;     ///< rate that the strength feels over the particle's own; or null for 1
};

class FlowStress {
 public:
  virtual ~FlowStress() = default;
  /// Solves trial - 3 G x = sigma_y(eps_p + x, f x/dt, T) for x >= 0, f the rate factor. Returns the number of
  /// iterations over the batch.
  virtual long return_map(const FlowBatch& batch) const = 0;
  /// sigma_y [Pa] at a plastic strain, plastic strain rate [1/s] and temperature [K].
  virtual double value(double plastic_strain, double rate, double temperature) const = 0;
  /// Whether sigma_y depends on the plastic strain rate.
  virtual bool rate_sensitive() const = 0;
  /// K, where the law ends; infinite when it knows none.
  virtual double melting_temperature() const { return std::numeric_limits<double>::infinity(); }
};

template <class Model>
class FlowStressOf final : public FlowStress {
 public:
  explicit FlowStressOf(Model model) : model_(std::move(model)) {}

  long return_map(const FlowBatch& b) const override {
    long iterations = 0;
    for (int k = 0; k < b.count; k += static_cast<int>(lanes)) iterations += return_map(b, k);
    return iterations;
  }
  double value(double plastic_strain, double rate, double temperature) const override {
    return model_.evaluate(plastic_strain, rate, temperature).stress;
  }
  bool rate_sensitive() const override { return model_.rate_sensitive(); }
  double melting_temperature() const override {
    if constexpr (requires { model_.melting_temperature; })
      return model_.melting_temperature;
    else
      return FlowStress::melting_temperature();
  }

 private:
  /// Newton's method kept inside a shrinking bracket, in the lanes from particle k on: the flow stress has a kink at
  /// the reference rate and an infinite slope at zero plastic strain, where plain Newton may leave the interval.
  long return_map(const FlowBatch& b, int k) const {
    const std::size_t count = static_cast<std::size_t>(b.count - k);
    const Lanes trial = load_lanes(b.trial + k, count, 0.0), strain = load_lanes(b.plastic_strain + k, count, 0.0),
                temperature = load_lanes(b.temperature + k, count, 300.0);
    const Lanes still = model_.evaluate(strain, Lanes(0.0), temperature).stress;
    Lanes increment = 0.0, strength = still;
    auto flowing = trial > still;
    long iterations = 0;
    if (stdx::any_of(flowing)) {
      const double three_g = 3 * b.shear_modulus;
      const Lanes per_time = (b.rate_factor ? load_lanes(b.rate_factor + k, count, 1.0) : Lanes(1.0)) / b.dt;
      constexpr double vanishing = 1e-290;  // below it the strain powers underflow
      Lanes low = 0.0, high = (trial - min(still, trial)) / three_g, x = high;
      if (b.previous_rate) {  // flow is steady more often than not
        const Lanes guess = load_lanes(b.previous_rate + k, count, 0.0) * b.dt;
        x = select(guess > 0.0 && guess < high, guess, x);
      }
      for (int iteration = 1; stdx::any_of(flowing); ++iteration) {
        iterations += stdx::popcount(flowing);
        const FlowPoint<Lanes> f = model_.evaluate(strain + x, x * per_time, temperature);
        const Lanes residual = trial - three_g * x - f.stress;
        stdx::where(residual > 0.0, low) = x;
        stdx::where(!(residual > 0.0), high) = x;
        const auto solved =
            flowing && (abs(residual) <= 1e-13 * trial || high - low <= 1e-15 * high || high < vanishing);
        stdx::where(solved, increment) = x;
        stdx::where(solved, strength) = trial - three_g * x;
        flowing = flowing && !solved;
        if (iteration == 200 && stdx::any_of(flowing)) {
          const int lane = stdx::find_first_set(flowing);
          throw BlowUp("the return map did not converge (trial stress " + std::to_string(trial[lane]) +
                       " Pa, plastic strain " + std::to_string(strain[lane]) + ", temperature " +
                       std::to_string(temperature[lane]) + " K)");
        }
        const Lanes newton = x + residual / (three_g + f.strain_slope + f.rate_slope * per_time);
        // Towards zero by decades: with a small hardening exponent a hair of overstress needs a strain of 1e-100 or
        // less.
        const Lanes bisection = select(low > 0.0, 0.5 * (low + high), 1e-3 * high);
        x = select(newton > low && newton < high, newton, bisection);
      }
    }
    store_lanes(increment, b.increment + k, count);
    store_lanes(strength, b.flow_stress + k, count);
    return iterations;
  }

  Model model_;
};

}  // namespace stirsph
