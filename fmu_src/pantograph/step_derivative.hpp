// The derivative of an HHT step: how its result changes with the state it began from and with the surroundings.
#pragma once

#include "hht.hpp"

namespace zspring {

// Variations are held in the same structures as what varies. `from` and `to` are the step's two ends; returns
// the variation of `to`. The memory of `from` and `dfrom` is moved to steps of h s. By the implicit function
// theorem on the converged step, so exact where the friction law has a slope and one-sided at the points where
// stick turns into slip.
MechanicalState step_derivative(const Hht& hht, const MechanicalState& from, const Boundary& b0, const Boundary& b1,
                                double h, const MechanicalState& to, const MechanicalState& dfrom, const Boundary& db0,
                                const Boundary& db1);

}  // namespace zspring
