// What the inputs do over one communication step: where the pantographs are, and how hard they press.
#pragma once

#include "common/time.hpp"
#include "line.hpp"

namespace zspring::catenary {

inline Loads loads_at(const Mesh& mesh, const Passage passage[pantographs]) {
  Loads l;
  for (int i = 0; i < pantographs; ++i) {
    l.on[i].place = mesh.at(passage[i].position);
    l.on[i].value = passage[i].force * l.on[i].place.value;
  }
  return l;
}

inline Passage initial_passage(const Parameters& p, int i, const PantographInputs& u) {
  if (p.travel == Travel::Speed) return {p.pantograph[i].start, u.speed.value, u.force.value};
  return {u.position.value, 0, u.force.value};
}

// What holds during one communication step.
struct Held {
  Inputs inputs;
  double length = 0;  // s; 0 before the first step
};
ZSPRING_MEMBERS(Held, inputs, length)

class CommunicationStep {
 public:
  CommunicationStep(const Line& line, const Passage begin[pantographs], const Held& held)
      : line_(line), begin_(begin), held_(held) {}

  // Linear in begin and inputs: of variations it returns the variation.
  Passage at(int i, double tau) const {
    const PantographInputs& u = held_.inputs.pantograph[i];
    const Passage& from = begin_[i];
    const double force = u.force.from(from.force, held_.length).at(tau);
    if (line_.p.travel == Travel::Position) {
      const Signal x = u.position.from(from.position, held_.length);
      return {x.at(tau), x.rate_at(tau), force};
    }
    const Signal speed = u.speed.from(from.speed, held_.length);
    return {from.position + speed.integral(tau), speed.at(tau), force};
  }

  // The force and the pantograph's motion go from where they were to where they are told to, without a jump.
  bool is_straight(int i) const {
    const PantographInputs& u = held_.inputs.pantograph[i];
    return !u.force.has_derivatives && !u.speed.has_derivatives && !u.position.has_derivatives;
  }

  Loads loads(double tau) const {
    const Passage here[pantographs] = {at(0, tau), at(1, tau)};
    return loads_at(line_.mesh, here);
  }
  // Their variation when `change` is that of this step.
  Loads loads_change(const CommunicationStep& change, double tau) const {
    Loads l = loads(tau);
    for (int i = 0; i < pantographs; ++i) {
      const Passage d = change.at(i, tau);
      const Place& place = l.on[i].place;
      l.on[i].value = d.force * place.value + at(i, tau).force * d.position * place.slope;
    }
    return l;
  }

  // m/s2, at the end.
  double speed_rate(int i) const {
    if (line_.p.travel == Travel::Position) return 0;
    return held_.inputs.pantograph[i].speed.from(begin_[i].speed, held_.length).rate_at(held_.length);
  }

  Count internal_steps() const { return zspring::internal_steps(held_.length, line_.p.solver.step); }
  double length() const { return held_.length; }

 private:
  const Line& line_;
  const Passage* begin_;
  const Held& held_;
};

}  // namespace zspring::catenary
