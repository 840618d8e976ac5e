// What a user reads, from the state; and how it changes with the state.
#pragma once

#include "bench.hpp"
#include "hht.hpp"

namespace zspring {

Outputs outputs(const Hht& hht, const MechanicalState& state, const BenchState& bench);

// The variation of the outputs with the variation `d` of `state`; 0 for what only counts or averages.
Outputs outputs_change(const Hht& hht, const MechanicalState& state, const MechanicalState& d);

// The true accelerations at this instant, from the balance of forces; HHT's where a mass is 0, m/s2 and rad/s2.
Vector5 acceleration(const Hht& hht, const MechanicalState& state);

}  // namespace zspring
