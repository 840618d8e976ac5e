// Derivatives of the outputs, with respect to time and to the inputs.
#include <algorithm>
#include <utility>

#include "simulation.hpp"

namespace zspring::catenary {

Outputs Simulation::output_rates() {
  const LineState& s = state_.line;
  LineState d;
  d.u = s.v;
  d.v = s.a;
  if (line_.p.solver.energies) {
    d.kinetic = hht_.kinetic_change(s, s.a);
    d.dissipated = s.loss_power;
    d.work = loads_at(line_.mesh, s.passage).dot(s.v);
    d.elastic = s.v.dot(s.internal) - d.dissipated + d.work;
  }
  const CommunicationStep step(line_, before_.line.passage, held_);
  for (int i = 0; i < pantographs; ++i) {
    d.passage[i].position = s.passage[i].speed;
    if (held_.length > 0) d.passage[i].speed = step.speed_rate(i);
  }
  return change(d);
}

Outputs Simulation::outputs_change(const Inputs& direction) {
  if (line_.p.exchange == Exchange::Parallel)
    refuse("exchange = Parallel: has no directional derivatives, as its force inputs belong to the begin of a step");
  if (ended_with_leftover()) return {};
  const double length = held_.length;
  if (length == 0) {
    Passage changed[pantographs];
    Loads dloads = loads_at(line_.mesh, state_.line.passage);
    for (int i = 0; i < pantographs; ++i) {
      changed[i] = initial_passage(line_.p, i, direction.pantograph[i]);
      if (line_.p.travel == Travel::Speed) changed[i].position = 0;  // a parameter
      const Place& place = dloads.on[i].place;
      dloads.on[i].value =
          changed[i].force * place.value + state_.line.passage[i].force * changed[i].position * place.slope;
    }
    LineState d = hht_.at_rest_variation(dloads, state_.line.slack).d;
    std::copy_n(changed, pantographs, d.passage);
    if (line_.p.solver.energies) d.elastic = loads_at(line_.mesh, state_.line.passage).dot(d.u);
    return change(d);
  }
  // Only values vary; whether they are targets does not.
  Held changed{direction, length};
  for (int i = 0; i < pantographs; ++i) {
    for (auto signal : {&PantographInputs::force, &PantographInputs::speed, &PantographInputs::position})
      (changed.inputs.pantograph[i].*signal).has_derivatives = (held_.inputs.pantograph[i].*signal).has_derivatives;
  }
  const Passage nothing[pantographs] = {};
  const CommunicationStep step(line_, before_.line.passage, held_), change_of(line_, nothing, changed);
  const double n = static_cast<double>(step.internal_steps());
  const StepFactors& factors = hht_.factors(length / n);
  const bool with_energies = line_.p.solver.energies;

  Variation& v = varied_;
  LineState& d = v.d;
  v.clear();
  d.h = before_.line.h;
  Loads l0 = step.loads(0), dl0 = step.loads_change(change_of, 0);
  Loads none = dl0;
  for (PointLoad& l : none.on) l.value.setZero();
  if (!(none == dl0)) {
    hht_.jump(none, dl0, d);
    v.on = {0, line_.mesh.stations()};
  }
  LineState now, next;  // the steps before the last are done again
  if (n > 1) {
    now = next = before_.line;
    hht_.jump(loads_at(line_.mesh, before_.line.passage), l0, now);
  }
  const LineState& from = n > 1 ? now : before_.line;
  for (Count k = 1; k <= step.internal_steps(); ++k) {
    const Loads l1 = step.loads(k / n * length), dl1 = step.loads_change(change_of, k / n * length);
    if (k < n) {
      if (!hht_.step(factors, l1, now, next)) break;  // not reached: it was solved before
      if (with_energies) hht_.account(factors, l0, l1, now, next);
    }
    const LineState& to = k < n ? next : state_.line;
    if (with_energies) {
      d.work -= 0.5 * (dl0.dot(from.u) + dl1.dot(from.u) + l0.dot(d.u) + l1.dot(d.u));
      d.dissipated += 0.5 * factors.h * (d.v.dot(from.damping) + d.v.dot(to.damping));
    }
    hht_.step_variation(factors, dl1, to, v);
    if (with_energies) {
      d.work += 0.5 * (dl0.dot(to.u) + dl1.dot(to.u) + l0.dot(d.u) + l1.dot(d.u));
      d.dissipated += 0.5 * factors.h * (d.v.dot(from.damping) + d.v.dot(to.damping));
      d.elastic = d.u.dot(to.internal) - d.u.dot(to.damping) + l1.dot(d.u);
    }
    if (k < n) std::swap(now, next);
    l0 = l1;
    dl0 = dl1;
  }
  if (with_energies) d.kinetic = hht_.kinetic_change(state_.line, d.v);
  for (int i = 0; i < pantographs; ++i) d.passage[i] = change_of.at(i, length);
  return change(d);
}

}  // namespace zspring::catenary
