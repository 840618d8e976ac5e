#include "simulation.hpp"

#include <algorithm>
#include <utility>

namespace zspring::catenary {

Simulation::Simulation(const Parameters& parameters, const Inputs& inputs) : line_(parameters), hht_(line_) {
  facts_.length = line_.mesh.length();
  facts_.dropper_force_min = line_.shape.tension.size() > 0 ? line_.shape.tension.minCoeff() : 0;
  Passage placed[pantographs];
  for (int i = 0; i < pantographs; ++i) {
    const Passage& at = placed[i] = initial_passage(line_.p, i, inputs.pantograph[i]);
    if (at.force != 0 && !line_.mesh.contains(at.position))
      refuse(
          "pantograph[%d].%s = %.10g m: must be within the line, 0 to %.10g m, as pantograph[%d].force = %.10g N",
          i + 1, line_.p.travel == Travel::Speed ? "start" : "position", at.position, facts_.length, i + 1,
          at.force);
  }
  std::optional<LineState> rest = hht_.at_rest(loads_at(line_.mesh, placed));
  if (!rest)
    refuse(
        "pantograph[1].force = %.10g N, pantograph[2].force = %.10g N: no equilibrium of the line under them "
        "was found, where the run would begin",
        placed[0].force, placed[1].force);
  state_ = *std::move(rest);
  std::copy_n(placed, pantographs, state_.passage);
  before_ = next_ = state_;
  held_ = inputs;
  if (!all_finite(outputs())) refuse(overflow);
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
          text("pantograph[%d].x = %.10g m: must be within the line, 0 to %.10g m, while its force is %.10g N",
               i + 1, here.position, facts_.length, here.force),
          at_end};
    }
  return std::nullopt;
}

std::optional<Discard> Simulation::advance(const Inputs& inputs, double length) {
  if (const std::optional<Discard> discard = too_long(length, line_.p.step)) return discard;
  const CommunicationStep step(line_, state_.passage, inputs, length);
  if (const std::optional<Discard> discard = leaves_line(step)) return discard;
  const double n = static_cast<double>(step.internal_steps());
  const StepFactors& factors = hht_.factors(length / n);
  next_ = state_;
  Loads l0 = step.loads(0);
  hht_.jump(loads_at(line_.mesh, state_.passage), l0, next_);
  for (Count k = 1; k <= step.internal_steps(); ++k) {
    const Loads l1 = step.loads(k / n * length);
    if (!hht_.step(factors, l0, l1, next_))
      return Discard{k / n * length, text("no set of slack droppers fits, or the values overflow")};
    l0 = l1;
  }
  for (int i = 0; i < pantographs; ++i) next_.passage[i] = step.at(i, length);
  std::swap(state_, next_);
  forget_outputs();
  if (!all_finite(outputs())) {
    std::swap(state_, next_);
    forget_outputs();
    return Discard{length, text("%s", overflow)};
  }
  std::swap(before_, next_);
  held_ = inputs;
  length_ = length;
  return std::nullopt;
}

bool Simulation::is_possible() const {
  for (const LineState* s : {&state_, &before_})
    if (!(s->h >= 0 && (s->slack.array() >= 0).all())) return false;
  return length_ >= 0 && !too_long(length_, line_.p.step);
}

Text Simulation::describe_run() const {
  const Statistics& n = state_.statistics;
  return text("%.0f steps, %.3g linear systems a step for the slack droppers, at most %.0f",
              static_cast<double>(n.steps), n.iterations_per_step(), static_cast<double>(n.iterations_max));
}

}  // namespace zspring::catenary
