#include "simulation.hpp"

#include <algorithm>
#include <utility>

namespace zspring::catenary {

Simulation::Simulation(const Parameters& parameters, const Inputs& inputs) : line_(parameters), hht_(line_) {
  calculated_.line.length = line_.mesh.length();
  calculated_.dropper.static_force_min = line_.shape.tension.size() > 0 ? line_.shape.tension.minCoeff() : 0;
  Passage placed[pantographs];
  for (int i = 0; i < pantographs; ++i) {
    const Passage& at = placed[i] = initial_passage(line_.p, i, inputs.pantograph[i]);
    if (at.force != 0 && !line_.mesh.contains(at.position))
      refuse("pantograph[%d].%s = %.10g m: must be within the line, 0 to %.10g m, as pantograph[%d].force = %.10g N",
             i + 1, line_.p.travel == Travel::Speed ? "start" : "position", at.position, calculated_.line.length, i + 1,
             at.force);
  }
  std::optional<LineState> rest = hht_.at_rest(loads_at(line_.mesh, placed));
  if (!rest)
    refuse(
        "pantograph[1].force = %.10g N, pantograph[2].force = %.10g N: no equilibrium of the line under them "
        "was found, where the run would begin",
        placed[0].force, placed[1].force);
  std::copy_n(placed, pantographs, rest->passage);
  begin(*std::move(rest), {inputs, 0});
}

std::optional<Discard> Simulation::leaves_line(const CommunicationStep& step) const {
  const Count n = step.internal_steps();
  for (Count k = 0; k <= n; ++k)
    for (int i = 0; i < pantographs; ++i) {
      const double tau = k / static_cast<double>(n) * step.length();
      const Passage here = step.at(i, tau);
      if (here.force == 0 || line_.mesh.contains(here.position)) continue;
      const bool at_end = true;
      return Discard{
          tau,
          text("pantograph[%d].x = %.10g m: must be within the line, 0 to %.10g m, while its force is %.10g N", i + 1,
               here.position, calculated_.line.length, here.force),
          at_end};
    }
  return std::nullopt;
}

std::optional<Discard> Simulation::run(const Held& held) {
  const CommunicationStep step(line_, begin_.passage, held);
  if (const std::optional<Discard> discard = leaves_line(step)) return discard;
  const double n = static_cast<double>(step.internal_steps());
  const StepFactors& factors = hht_.factors(held.length / n);
  Loads l0 = step.loads(0);
  hht_.jump(loads_at(line_.mesh, begin_.passage), l0, state_);
  for (Count k = 1; k <= step.internal_steps(); ++k) {
    const Loads l1 = step.loads(k / n * held.length);
    if (!hht_.step(factors, l0, l1, state_))
      return Discard{k / n * held.length, text("no set of slack droppers fits, or the values overflow")};
    l0 = l1;
  }
  for (int i = 0; i < pantographs; ++i) state_.passage[i] = step.at(i, held.length);
  return std::nullopt;
}

bool Simulation::is_possible(const LineState& s) const { return s.h >= 0 && (s.slack.array() >= 0).all(); }

Text Simulation::describe_run() const {
  const Statistics& n = state_.statistics;
  return text("%.0f steps, %.3g linear systems a step for the slack droppers, at most %.0f",
              static_cast<double>(n.steps), n.iterations_per_step(), static_cast<double>(n.iterations_max));
}

}  // namespace zspring::catenary
