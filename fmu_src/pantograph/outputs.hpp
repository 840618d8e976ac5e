// What a user reads, from the state; and how it changes with the state.
#pragma once

#include "bench.hpp"
#include "common/outputs.hpp"
#include "hht.hpp"

namespace zspring {

// What the definitions in outputs.cpp are written with.
struct View {
  View(const Hht& integrator, const MechanicalState& state, const BenchState& analysis)
      : hht(integrator),
        m(hht.mechanics()),
        s(state),
        bench(analysis),
        head(m.head_response(s.q).value_or(ElementResponse())) {}

  const Hht& hht;
  const Mechanics& m;
  const MechanicalState& s;
  const BenchState& bench;
  ElementResponse head;  // there is one: the spring of an accepted state has a direction
};

// The true accelerations at this instant, from the balance of forces; HHT's where a mass is 0, m/s2 and rad/s2.
Vector5 acceleration(const Hht& hht, const MechanicalState& state);

}  // namespace zspring
