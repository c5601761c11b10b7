#include "bench/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "base/simd.hpp"
#include "driver/run.hpp"

namespace stirsph::bench {
namespace {

/// A JSON string; control characters do not occur in what is reported.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + "\"";
}

std::string number(double value) { return fmt::format("{:.9g}", value); }

std::string origin_json(int ranks) {
  const Processor cpu = processor();
  return fmt::format(
      R"("machine": {{"cpu": {}, "family": {}, "model": {}, "lanes": {}, "compiler": {}}}, "commit": {}, "ranks": {})",
      quoted(cpu.model), quoted(cpu.family), quoted(cpu.model_number), lanes,
      quoted(fmt::format("g++ {}", __VERSION__)), quoted(source_commit()), ranks);
}

std::string options_json(const Options& options) {
  return fmt::format(R"("scene": {}, "options": {{"particles": {}, "gradient_correction": {}, "repeats": {}}})",
                     quoted(options.scene), options.particles, quoted(options.gradient_correction), options.repeats);
}

std::vector<double> rates_of(const Measurement& m) {
  std::vector<double> rates;
  for (const Window& window : m.windows) rates.push_back(m.rate(window));
  return rates;
}

std::string processor_line() {
  const Processor cpu = processor();
  return fmt::format("{}\n{}, family {}, model {}\n", version_text(), cpu.model, cpu.family, cpu.model_number);
}

}  // namespace

std::string text_report(const Options& options, const Measurement& m) {
  const Window& median = m.median();
  const std::vector<double> rates = rates_of(m);
  std::string text =
      processor_line() + fmt::format(
                             "scene {}: {} particles of {:.4g} mm, {} steps of {:.3g} s, {:.1f} neighbours, {:.1f} "
                             "candidates per cluster, {} list rebuilds, {:.0f} % yielding, gradient correction {}\n",
                             options.scene, m.particles, 1e3 * m.spacing, m.steps, m.dt, m.neighbours, m.candidates,
                             median.rebuilds, 100 * m.yielding, options.gradient_correction);
  for (const auto& [name, phase] : median.phases)
    text += fmt::format("  {:<12} {:9.4f} s mean ({:.4f} .. {:.4f} over ranks), {:5.1f} %\n", name, phase.mean,
                        phase.least, phase.most, 100 * phase.mean / median.seconds);
  text += fmt::format("bytes per particle: {:.0f} particles, {:.0f} list, {:.0f} mechanics\n", m.memory.particles,
                      m.memory.list, m.memory.mechanics);
  if (m.windows.size() > 1)
    text += fmt::format("particle-steps/s per core of {} repeats: {:.4g} .. {:.4g}, median {:.4g}\n", m.windows.size(),
                        *std::ranges::min_element(rates), *std::ranges::max_element(rates), m.rate(median));
  if (options.scene == "extrusion")
    text += fmt::format("contact, integration, ledger, output and the rest: {:.1f} % of the step\n",
                        100 * m.service_share());
  return text + fmt::format(
                    "particle_steps_per_s_per_core={:.4g} neighbours={:.2f} bytes_per_particle={:.0f} ranks={} "
                    "rebuild_cost_steps={:.3g} steps_per_list={:.3g} step_overhead_us={:.4g}\n",
                    m.rate(median), m.neighbours, m.memory.total(), m.ranks, m.rebuild_cost_steps(), m.steps_per_list(),
                    m.step_overhead_us());
}

std::string json_report(const Options& options, const Measurement& m) {
  const Window& median = m.median();
  std::string rates, phases;
  for (const double rate : rates_of(m)) rates += (rates.empty() ? "" : ", ") + number(rate);
  for (const auto& [name, phase] : median.phases)
    phases += fmt::format(R"({}{}: {{"min": {}, "mean": {}, "max": {}}})", phases.empty() ? "" : ", ", quoted(name),
                          number(phase.least), number(phase.mean), number(phase.most));
  return fmt::format(
      R"({{{}, {}, "particles": {}, "spacing": {}, "dt": {}, "steps": {}, "seconds": {}, "cpu_share": {}, "rebuilds": {},
"particle_steps_per_s_per_core": {}, "rates": [{}], "neighbours": {}, "candidates_per_cluster": {}, "visited_per_register": {}, "yielding": {}, "contact_looks": {}, "contact_search": {}, "contact_searches": {},
"bytes_per_particle": {}, "bytes": {{"particles": {}, "list": {}, "mechanics": {}}},
"rebuild_cost_steps": {}, "steps_per_list": {}, "step_overhead_us": {}, "service_share": {},
"phases": {{{}}}}}
)",
      origin_json(m.ranks), options_json(options), m.particles, number(m.spacing), number(m.dt), m.steps,
      number(median.seconds), number(median.cpu_share), median.rebuilds, number(m.rate(median)), rates,
      number(m.neighbours), number(m.candidates), number(m.visited), number(m.yielding), number(m.contact_looks),
      number(m.contact_search), number(m.contact_searches), number(m.memory.total()), number(m.memory.particles),
      number(m.memory.list), number(m.memory.mechanics), number(m.rebuild_cost_steps()), number(m.steps_per_list()),
      number(m.step_overhead_us()), number(m.service_share()), phases);
}

std::string text_report(const MachineRates& rates, int ranks) {
  return processor_line() + fmt::format(
                                "multiply_add_gflops={:.4g} add_gops={:.4g} divide_gops={:.4g} square_root_gops={:.4g} "
                                "triad_gb_per_s={:.4g} "
                                "ranks={}\n",
                                1e-9 * rates.multiply_add, 1e-9 * rates.add, 1e-9 * rates.divide,
                                1e-9 * rates.square_root, 1e-9 * rates.triad, ranks);
}

std::string json_report(const MachineRates& rates, int ranks) {
  return fmt::format(
      R"({{{}, "scene": "machine", "multiply_add": {}, "add": {}, "divide": {}, "square_root": {}, "triad": {}}}
)",
      origin_json(ranks), number(rates.multiply_add), number(rates.add), number(rates.divide),
      number(rates.square_root), number(rates.triad));
}

std::string json_report(const Options& options, std::int64_t particles, double spacing, int ranks) {
  return fmt::format("{{{}, {}, \"particles\": {}, \"spacing\": {}}}\n", origin_json(ranks), options_json(options),
                     particles, number(spacing));
}

}  // namespace stirsph::bench
