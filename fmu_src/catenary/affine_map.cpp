#include "affine_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
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
  return line.course(s.u, line.at(s.passage[i].position)).height;
}

Foresight::Foresight(const Line& line, Hht& hht)
    : line_(line),
      hht_(hht),
      ahead_(LineState::at_rest(line)),
      between_(ahead_),
      jumped_(ahead_),
      last_(line),
      begin_(line),
      end_(line) {}

void Foresight::OfForce::begin(bool used) {
  clear();
  is_used = used;
  least = -std::numeric_limits<double>::infinity();
  most = -least;
}

// Which part of what it may do a change makes use of.
double Foresight::OfForce::part(double change) const {
  if (change == 0) return 0;
  const double bound = change > 0 ? most : least;
  return is_used && bound != 0 ? change / bound : HUGE_VAL;
}

// If these sum up to 1 at most, all may do so at once: what each leaves of a dropper's room is linear in its change.
double Foresight::OfForces::part(const double change[pantographs]) const {
  double sum = 0;
  for (int i = 0; i < pantographs; ++i) sum += on[i].part(change[i]);
  return sum;
}

void Foresight::OfForces::add_to(LineState& s, const double change[pantographs]) const {
  for (int i = 0; i < pantographs; ++i)
    if (change[i] != 0) on[i].add_to(s, change[i]);
}

bool Foresight::is_there(const Passage& at, int i) const {
  return at.force != 0 || at.speed != 0 || line_.p.pantograph[i].static_force != 0;
}

bool Foresight::advance(const CommunicationStep& step, const LineState& from, LineState& to, bool end_varies) {
  if (end_varies)
    for (int i = 0; i < pantographs; ++i) end_.on[i].begin(is_there(step.at(i, step.length()), i));
  return through(step, from, to, line_.p.solver.energies, nullptr, end_varies ? &end_ : nullptr);
}

void Foresight::begin_known() {
  for (OfForce& v : last_.on) v.begin(false);
}

void Foresight::begin_unknown(double room) {
  std::swap(last_, end_);
  for (OfForce& v : last_.on) v.least *= room, v.most *= room;
}

void Foresight::begin_at_rest(const LineState& s) {
  for (int i = 0; i < pantographs; ++i) {
    OfForce& v = last_.on[i];
    v.begin(is_there(s.passage[i], i));
    if (!v.is_used) continue;
    Loads unit;
    unit.on[i].place = line_.mesh.at(s.passage[i].position);
    unit.on[i].value = unit.on[i].place.value;
    static_cast<Variation&>(v) = hht_.at_rest_variation(unit, s.slack);
    bound(s, v);
  }
}

bool Foresight::look(const LineState& s, double length, AffineMap maps[pantographs]) {
  for (int i = 0; i < pantographs; ++i) {
    begin_.on[i].begin(last_.on[i].is_used);
    begin_.on[i].take_over(last_.on[i]);
    end_.on[i].begin(is_there(s.passage[i], i));
  }
  const Held held = going_on(s, length);
  const CommunicationStep step(line_, s.passage, held);
  forget();
  if (!through(step, s, ahead_, false, &begin_, &end_)) return false;
  foreseen_ = length;
  for (int i = 0; i < pantographs; ++i) {
    const Place place = line_.mesh.at(ahead_.passage[i].position);
    const auto compliance = [&](const OfForce& v) { return v.is_used ? place.value.dot(place.of(v.d.u)) : 0; };
    maps[i].compliance = compliance(end_.on[i]);
    maps[i].previous = compliance(begin_.on[i]);
    maps[i].free = height_under(line_, ahead_, i) - (maps[i].compliance + maps[i].previous) * s.passage[i].force;
  }
  return true;
}

// The energies of several internal steps are not linear in the forces.
bool Foresight::can_superpose(const CommunicationStep& step) const {
  return step.internal_steps() == 1 || !line_.p.solver.energies;
}

bool Foresight::foresaw(const CommunicationStep& step, const ForceChange& change) const {
  constexpr double close = 1e-9, near = 1e-10;  // of the length, and m: hosts add up times and places
  if (!can_superpose(step) || !(std::abs(step.length() - foreseen_) <= close * foreseen_)) return false;
  for (int i = 0; i < pantographs; ++i) {
    const Passage end = step.at(i, step.length());
    if (!step.is_straight(i) || is_there(end, i) != end_.on[i].is_used) return false;
    if (end_.on[i].is_used && !(std::abs(end.position - ahead_.passage[i].position) <= near)) return false;
  }
  return begin_.part(change.begin) + end_.part(change.end) <= 1;
}

double Foresight::take(const CommunicationStep& step, const LineState& from, const ForceChange& change, LineState& to) {
  std::swap(to, ahead_);
  forget();
  begin_.add_to(to, change.begin);
  end_.add_to(to, change.end);
  finish(step, from, to);
  return 1 - begin_.part(change.begin) - end_.part(change.end);
}

bool Foresight::can_correct(const CommunicationStep& step, const ForceChange& change) const {
  return can_superpose(step) && last_.part(change.end) <= 1;
}

void Foresight::correct(const CommunicationStep& step, const LineState& from, const ForceChange& change,
                        LineState& to) {
  last_.add_to(to, change.end);
  finish(step, from, to);
}

void Foresight::finish(const CommunicationStep& step, const LineState& from, LineState& to) {
  for (int i = 0; i < pantographs; ++i) to.passage[i] = step.at(i, step.length());
  to.slack = to.slack.cwiseMax(0.0);  // what rounding left
  if (line_.p.solver.energies) hht_.account(hht_.factors(to.h), step.loads(0), step.loads(step.length()), from, to);
}

// Of what happens at each internal step the bounds hold what is allowed in all.
void Foresight::bound(const LineState& s, OfForce& v) const {
  constexpr double tolerance = 1e-9;  // N, as droppers are told slack or taut
  const Range droppers = droppers_at(line_.mesh, v.on);
  for (int j = droppers.begin; j < droppers.end; ++j) {
    const bool is_slack = s.slack[j] > 0;
    const double stiffness = line_.shape.stiffness[j];
    const double room = is_slack ? s.slack[j] + tolerance / stiffness
                                 : line_.shape.tension[j] + stiffness * stretch(line_.mesh, s.u, j) + tolerance;
    const double change = is_slack ? v.d.slack[j] : stiffness * stretch(line_.mesh, v.d.u, j);
    if (change > 0) v.least = std::max(v.least, -std::max(room, 0.0) / change);
    if (change < 0) v.most = std::min(v.most, -std::max(room, 0.0) / change);
  }
}

bool Foresight::through(const CommunicationStep& step, const LineState& start, LineState& to, bool with_energies,
                        OfForces* begin, OfForces* end) {
  const Count steps = step.internal_steps();
  const double n = static_cast<double>(steps), length = step.length();
  const StepFactors& factors = hht_.factors(length / n);
  Loads l0 = step.loads(0);
  const Loads before = loads_at(line_.mesh, start.passage);
  const LineState* from = &start;
  if (!(before == l0)) {
    jumped_ = start;
    hht_.jump(before, l0, jumped_);
    from = &jumped_;
  }
  for (OfForces* all : {begin, end})
    if (all)
      for (OfForce& v : all->on) v.d.h = start.h;
  for (Count k = 1; k <= steps; ++k) {
    const double x = k / n;
    const Loads l1 = step.loads(x * length);
    LineState& next = (steps - k) % 2 == 0 ? to : between_;  // the last one is `to`
    if (!hht_.step(factors, l1, *from, next)) return false;
    if (with_energies) hht_.account(factors, l0, l1, *from, next);
    const auto vary = [&](OfForces* all, double force) {
      if (!all) return;
      for (int i = 0; i < pantographs; ++i) {
        OfForce& v = all->on[i];
        if (!v.is_used) continue;
        Loads change;
        change.on[i].place = l1.on[i].place;
        change.on[i].value = force * l1.on[i].place.value;
        hht_.step_variation(factors, change, next, v);
        bound(next, v);
      }
    };
    vary(begin, 1 - x);
    vary(end, x);
    l0 = l1;
    from = &next;
  }
  for (int i = 0; i < pantographs; ++i) to.passage[i] = step.at(i, length);
  return true;
}

}  // namespace zspring::catenary
