#include "affine_map.hpp"

#include <utility>

namespace zspring::catenary {
namespace {

// Going on from `s` with its speeds and forces.
Held going_on(const LineState& s, double length) {
  Held held;
  held.length = length;
  for (int i = 0; i < pantographs; ++i) {
    const Passage& at = s.passage[i];
    held.inputs.pantograph[i].force.value = at.force;
    held.inputs.pantograph[i].speed.value = at.speed;
    held.inputs.pantograph[i].position.value = at.position + length * at.speed;
  }
  return held;
}

}  // namespace

double height_under(const Line& line, const LineState& s, int i) {
  const Place place = line.mesh.at(s.passage[i].position);
  return place.value.dot(line.heights(s.u, place));
}

Foresight::Foresight(const Line& line, Hht& hht) : line_(line), hht_(hht) {
  for (int i = 0; i < pantographs; ++i)
    for (Variation* v : {&of_begin_[i], &of_end_[i]}) v->d = LineState::at_rest(line);
}

void Foresight::Variation::begin(bool used) {
  is_used = used;
  if (used) d.set_zero();
}

bool Foresight::is_there(const Passage& at, int i) const {
  return at.force != 0 || at.speed != 0 || line_.p.pantograph[i].static_force != 0;
}

bool Foresight::advance(const CommunicationStep& step, LineState& s, bool end_unknown) {
  for (int i = 0; i < pantographs; ++i) {
    of_begin_[i].is_used = false;
    of_end_[i].begin(end_unknown && is_there(step.at(i, step.length()), i));
  }
  if (!through(step, s, true)) return false;
  for (int i = 0; i < pantographs; ++i) std::swap(of_begin_[i], of_end_[i]);
  return true;
}

void Foresight::begin_at_rest(const LineState& s) {
  for (int i = 0; i < pantographs; ++i) {
    of_begin_[i].is_used = is_there(s.passage[i], i);
    if (!of_begin_[i].is_used) continue;
    Loads unit;
    unit.on[i].place = line_.mesh.at(s.passage[i].position);
    unit.on[i].value = unit.on[i].place.value;
    of_begin_[i].d = hht_.at_rest_variation(unit, s.slack);
  }
}

bool Foresight::look(const LineState& s, double length, AffineMap maps[pantographs]) {
  for (int i = 0; i < pantographs; ++i) of_end_[i].begin(is_there(s.passage[i], i));
  const Held held = going_on(s, length);
  const CommunicationStep step(line_, s.passage, held);
  ahead_ = s;
  if (!through(step, ahead_, false)) return false;
  for (int i = 0; i < pantographs; ++i) {
    const Place place = line_.mesh.at(ahead_.passage[i].position);
    const auto compliance = [&](const Variation& v) { return v.is_used ? place.value.dot(place.of(v.d.u)) : 0; };
    maps[i].compliance = compliance(of_end_[i]);
    maps[i].previous = compliance(of_begin_[i]);
    maps[i].free = height_under(line_, ahead_, i) - (maps[i].compliance + maps[i].previous) * s.passage[i].force;
  }
  return true;
}

bool Foresight::through(const CommunicationStep& step, LineState& s, bool with_energies) {
  const double n = static_cast<double>(step.internal_steps()), length = step.length();
  const StepFactors& factors = hht_.factors(length / n);
  Loads l0 = step.loads(0);
  hht_.jump(loads_at(line_.mesh, s.passage), l0, s);
  for (Count k = 1; k <= step.internal_steps(); ++k) {
    const double x = k / n;
    const Loads l1 = step.loads(x * length);
    if (!hht_.step(factors, l0, l1, s, with_energies)) return false;
    const auto vary = [&](Variation& v, int i, double force) {
      if (!v.is_used) return;
      Loads change;
      change.on[i].place = l1.on[i].place;
      change.on[i].value = force * l1.on[i].place.value;
      hht_.step_variation(factors, change, s, v.d);
    };
    for (int i = 0; i < pantographs; ++i) {
      vary(of_begin_[i], i, 1 - x);
      vary(of_end_[i], i, x);
    }
    l0 = l1;
  }
  for (int i = 0; i < pantographs; ++i) s.passage[i] = step.at(i, length);
  return true;
}

}  // namespace zspring::catenary
