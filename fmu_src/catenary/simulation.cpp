#include "simulation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace zspring::catenary {
namespace {

Discard no_slack(double time) { return {time, text("no set of slack droppers fits, or the values overflow")}; }

}  // namespace

Simulation::Simulation(const Parameters& parameters, const Inputs& inputs, const LineTable* table)
    : line_(parameters, table ? *table : LineTable::of(parameters)),
      hht_(line_),
      foresight_(line_, hht_),
      varied_(Variation::of_nothing(line_)) {
  const Parameters& p = line_.p;
  calculated_.line.length = line_.mesh.length();
  calculated_.dropper.static_force_min =
      line_.shape.tension.size() > 0 ? std::max(line_.shape.tension.minCoeff(), 0.0) : 0;
  Passage placed[pantographs], expected[pantographs];
  bool as_expected = true;
  for (int i = 0; i < pantographs; ++i) {
    Passage& at = placed[i] = initial_passage(p, i, inputs.pantograph[i]);
    expected[i] = {at.position, at.speed, p.pantograph[i].static_force};
    // Tools that exchange values for the first time in the first step leave the input at 0 until then.
    if (p.exchange != Exchange::Target && expected[i].force > 0) at.force = expected[i].force;
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
    if (expected[i].force > 0) state.datum[i] = state.map[i].free;
  }
  if (p.exchange != Exchange::Target) {
    state.foreseen = p.exchange_step;
    foresight_.begin_at_rest(rest);
    if (!foresight_.look(rest, state.foreseen, state.map))
      refuse("exchange.step = %g s: no set of slack droppers fits in the first step", p.exchange_step);
  }
  state.line = as_expected ? rest : at_rest(placed);
  if (!as_expected) foresight_.forget();
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
  std::copy_n(state_.map, pantographs, next_.map);
  std::copy_n(state_.datum, pantographs, next_.datum);
  next_.guessed = state_.guessed;
  next_.foreseen = state_.foreseen;
  next_.was_foreseen = false;
  next_.room = 1;
  switch (line_.p.exchange) {
    case Exchange::Sequential:
      return run_sequential(told);
    case Exchange::Parallel:
      return run_parallel(told);
    case Exchange::Target:
      break;
  }
  const CommunicationStep step(line_, state_.line.passage, told);
  if (std::optional<Discard> discard = leaves_line(step)) return discard;
  if (!foresight_.advance(step, state_.line, next_.line, false)) return no_slack(told.length);
  for (int i = 0; i < pantographs; ++i) next_.map[i].free = height_under(line_, next_.line, i);
  return std::nullopt;
}

std::optional<Discard> Simulation::run_sequential(const Held& told) {
  const CommunicationStep step(line_, state_.line.passage, told);
  if (std::optional<Discard> discard = leaves_line(step)) return discard;
  if (!look_again()) return no_slack(0);
  ForceChange change;
  for (int i = 0; i < pantographs; ++i) change.end[i] = step.at(i, told.length).force - state_.line.passage[i].force;
  if (foresight_.foresaw(step, change))
    foresight_.take(step, state_.line, change, next_.line);
  else if (!foresight_.advance(step, state_.line, next_.line, false))
    return no_slack(told.length);
  foresight_.begin_known();
  return look_ahead(told.length);
}

std::optional<Discard> Simulation::run_parallel(const Held& told) {
  ForceChange change;
  for (int i = 0; i < pantographs; ++i)
    change.begin[i] = change.end[i] = told.inputs.pantograph[i].force.value - state_.line.passage[i].force;
  Held held = told;
  for (PantographInputs& u : held.inputs.pantograph) u.force = Signal{u.force.value};
  next_.guessed = held;

  bool corrected = false;
  if (!correct_guess(told, change, corrected)) return no_slack(0);
  const CommunicationStep step(line_, next_.known.passage, held);
  if (std::optional<Discard> discard = leaves_line(step)) return discard;
  next_.was_foreseen = corrected && foresight_.foresaw(step, change);
  if (next_.was_foreseen)
    next_.room = foresight_.take(step, next_.known, change, next_.line);
  else if (!foresight_.advance(step, next_.known, next_.line, true))
    return no_slack(told.length);
  foresight_.begin_unknown(next_.room);
  return look_ahead(told.length);
}

// The last step once more, to next_.known, with the forces at its end, which have come to be known. `corrected`: by
// what is known of it alone.
bool Simulation::correct_guess(const Held& told, const ForceChange& change, bool& corrected) {
  if (!look_again()) return false;
  if (state_.guessed.length == 0) {
    next_.known = state_.line;
    for (int i = 0; i < pantographs; ++i) next_.known.passage[i].force = told.inputs.pantograph[i].force.value;
    hht_.jump(loads_at(line_.mesh, state_.line.passage), loads_at(line_.mesh, next_.known.passage), next_.known);
    corrected = std::all_of(change.end, change.end + pantographs, [](double by) { return by == 0; });
    return true;
  }
  Held held = state_.guessed;
  for (int i = 0; i < pantographs; ++i) held.inputs.pantograph[i].force.value = told.inputs.pantograph[i].force.value;
  const CommunicationStep step(line_, state_.known.passage, held);
  corrected = foresight_.can_correct(step, change);
  if (!corrected) return foresight_.advance(step, state_.known, next_.known, false);
  next_.known = state_.line;
  foresight_.correct(step, state_.known, change, next_.known);
  return true;
}

// After the state was set or a step discarded: what had been foreseen from it, to the last bit.
bool Simulation::look_again() {
  if (foresight_.has_looked()) return true;
  AffineMap known[pantographs];
  foresight_.begin_known();
  if (state_.line.statistics.steps == 0) {
    if (is_as_expected())
      foresight_.begin_at_rest(state_.line);
    else if (line_.p.exchange == Exchange::Parallel)
      return true;  // nothing had been foreseen
  } else if (line_.p.exchange == Exchange::Parallel) {
    if (state_.was_foreseen) {
      if (!foresight_.look(before_.line, before_.foreseen, known)) return false;
    } else {
      const CommunicationStep step(line_, state_.known.passage, state_.guessed);
      if (!foresight_.advance(step, state_.known, next_.line, true)) return false;
    }
    foresight_.begin_unknown(state_.room);
  }
  return foresight_.look(state_.line, state_.foreseen, known);
}

bool Simulation::is_as_expected() const {
  for (int i = 0; i < pantographs; ++i)
    if (state_.line.passage[i].force != line_.p.pantograph[i].static_force) return false;
  return true;
}

std::optional<Discard> Simulation::look_ahead(double length) {
  next_.foreseen = length;
  if (!foresight_.look(next_.line, length, next_.map)) return no_slack(length);
  return std::nullopt;
}

bool Simulation::is_possible(const SimulationState& s) const {
  return s.line.h >= 0 && (s.line.slack.array() >= 0).all() && s.known.h >= 0 && (s.known.slack.array() >= 0).all() &&
         s.room >= 0 && s.room <= 1 && s.guessed.length >= 0 && !too_long(s.guessed.length, line_.p.solver.step) &&
         s.foreseen >= 0 && !too_long(s.foreseen, line_.p.solver.step);
}

std::optional<Text> Simulation::describe_doubt() const {
  if (line_.p.exchange == Exchange::Target || std::abs(held_.length - before_.foreseen) <= 1e-6 * held_.length)
    return std::nullopt;
  return text(
      "a communication step of %.10g s: the affine map was told for one of %.10g s, exchange.step or the last "
      "one, so that the pantographs met another wire",
      held_.length, before_.foreseen);
}

std::optional<Text> Simulation::describe_reading(Id output) const {
  const bool is_map = output == Id::pantograph_dot_compliance || output == Id::pantograph_dot_compliance_previous;
  if (!is_map || line_.p.exchange != Exchange::Target) return std::nullopt;
  return text(
      "0, as the wire that a pantograph meets is not told with exchange Target: values are exchanged once a step, "
      "which is less accurate; Sequential and Parallel tell it");
}

Text Simulation::describe_run() const {
  const Statistics& n = state_.line.statistics;
  return text("%.0f steps, %.3g linear systems a step for the slack droppers, at most %.0f",
              static_cast<double>(n.steps), n.iterations_per_step(), static_cast<double>(n.iterations_max));
}

}  // namespace zspring::catenary
