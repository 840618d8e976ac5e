// The unloaded line: where the wires hang, what each dropper carries, and how long it is.
#pragma once

#include "matrices.hpp"

namespace zspring::catenary {

struct StaticShape {
  VectorXd height;     // m and 1, of all degrees of freedom; the messenger's from the contact wire's level as well
  VectorXd tension;    // N, of the droppers at mid-length, > 0
  VectorXd length;     // m, of the droppers
  VectorXd stiffness;  // N/m, of the droppers
};

// The contact wire hangs at its prescribed height at every dropper and under its own weight between them; what it
// takes to hold it there is what the droppers carry. The messenger hangs under its own weight and theirs, at the
// encumbrance over its supports and anchors: whatever a support gives way is built in. The steady arms carry
// nothing. Throws Refusal where a dropper would have to push, or has no length.
StaticShape static_shape(const Parameters& p, const Mesh& mesh, const Matrices& matrices);

}  // namespace zspring::catenary
