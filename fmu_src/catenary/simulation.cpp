#include "simulation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace zspring::catenary {
namespace {

Discard no_slack(double time) { return {time, text("no set of slack droppers fits, or the values overflow")}; }

}  // namespace

Simulation::Simulation(const Parameters& parameters, const Inputs& inputs)
    : line_(parameters), hht_(line_), foresight_(line_, hht_) {
  const Parameters& p = line_.p;
  calculated_.line.length = line_.mesh.length();
  calculated_.dropper.static_force_min = line_.shape.tension.size() > 0 ? line_.shape.tension.minCoeff() : 0;
  Passage placed[pantographs], expected[pantographs];
  bool as_expected = true;
  for (int i = 0; i < pantographs; ++i) {
    const Passage& at = placed[i] = initial_passage(p, i, inputs.pantograph[i]);
    expected[i] = {at.position, at.speed, p.pantograph[i].static_force};
    as_expected = as_expected && at.force == expected[i].force;
    if ((at.force != 0 || expected[i].force > 0) && !line_.mesh.contains(at.position))
      refuse("pantograph[%d].%s = %.10g m: must be within the line, 0 to %.10g m, as pantograph[%d].%s = %.10g N",
             i + 1, p.travel == Travel::Speed ? "start" : "position", at.position, calculated_.line.length, i + 1,
             at.force != 0 ? "force" : "static_force", at.force != 0 ? at.force : expected[i].force);
  }
  SimulationState state;
  // The first map is that of the forces which are expected, not of those that a pantograph may just be working out
  // from it.
  const LineState rest = at_rest(expected);
  for (int i = 0; i < pantographs; ++i) {
    state.map[i].free = height_under(line_, rest, i);
    if (expected[i].force > 0) datum_[i] = state.map[i].free;
  }
  if (p.exchange != Exchange::Target) {
    state.foreseen = p.exchange_step;
    foresight_.begin_at_rest(rest);
    if (!foresight_.look(rest, state.foreseen, state.map))
      refuse("exchange.step = %g s: no set of slack droppers fits in the first step", p.exchange_step);
  }
  state.line = as_expected ? rest : at_rest(placed);
  if (p.exchange == Exchange::Parallel) state.known = state.line;
  begin(std::move(state), {inputs, 0});
}

LineState Simulation::at_rest(const Passage passage[pantographs]) {
  std::optional<LineState> rest = hht_.at_rest(loads_at(line_.mesh, passage));
  if (!rest)
    refuse(
        "pantograph[1].force = %.10g N, pantograph[2].force = %.10g N: no equilibrium of the line under them "
        "was found, where the run would begin",
        passage[0].force, passage[1].force);
  std::copy_n(passage, pantographs, rest->passage);
  return *std::move(rest);
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

std::optional<Discard> Simulation::run(const Held& told) {
  const Exchange exchange = line_.p.exchange;
  Held held = told;
  if (exchange == Exchange::Parallel) {
    if (!correct_guess(told)) return no_slack(0);
    state_.known = state_.line;
    for (PantographInputs& u : held.inputs.pantograph) u.force = Signal{u.force.value};
    state_.guessed = held;
  }
  const CommunicationStep step(line_, state_.line.passage, held);
  if (const std::optional<Discard> discard = leaves_line(step)) return discard;
  if (!foresight_.advance(step, state_.line, exchange == Exchange::Parallel)) return no_slack(held.length);
  if (exchange == Exchange::Target) {
    for (int i = 0; i < pantographs; ++i) state_.map[i].free = height_under(line_, state_.line, i);
    return std::nullopt;
  }
  state_.foreseen = held.length;
  if (!foresight_.look(state_.line, held.length, state_.map)) return no_slack(held.length);
  return std::nullopt;
}

// The last step once more, to the forces at its end, which have come to be known.
bool Simulation::correct_guess(const Held& told) {
  Held& held = state_.guessed;
  if (held.length == 0) {
    const Loads guessed = loads_at(line_.mesh, state_.line.passage);
    for (int i = 0; i < pantographs; ++i) state_.line.passage[i].force = told.inputs.pantograph[i].force.value;
    hht_.jump(guessed, loads_at(line_.mesh, state_.line.passage), state_.line);
    return true;
  }
  for (int i = 0; i < pantographs; ++i) held.inputs.pantograph[i].force = Signal{told.inputs.pantograph[i].force.value};
  state_.line = state_.known;
  const CommunicationStep step(line_, state_.known.passage, held);
  return foresight_.advance(step, state_.line, false);
}

bool Simulation::is_possible(const SimulationState& s) const {
  return s.line.h >= 0 && (s.line.slack.array() >= 0).all() && s.known.h >= 0 && (s.known.slack.array() >= 0).all() &&
         s.guessed.length >= 0 && !too_long(s.guessed.length, line_.p.solver.step) && s.foreseen >= 0;
}

std::optional<Text> Simulation::describe_doubt() const {
  if (line_.p.exchange == Exchange::Target || std::abs(held_.length - before_.foreseen) <= 1e-6 * held_.length)
    return std::nullopt;
  return text(
      "a communication step of %.10g s: the affine map was told for one of %.10g s, exchange.step or the last "
      "one, so that the pantographs met another wire",
      held_.length, before_.foreseen);
}

Text Simulation::describe_run() const {
  const Statistics& n = state_.line.statistics;
  return text("%.0f steps, %.3g linear systems a step for the slack droppers, at most %.0f",
              static_cast<double>(n.steps), n.iterations_per_step(), static_cast<double>(n.iterations_max));
}

}  // namespace zspring::catenary
