// The unloaded line: where the wires hang, what each dropper carries, and how long it is.
#pragma once

#include "matrices.hpp"

namespace zspring::catenary {

struct StaticShape {
  // m and 1, of all degrees of freedom over the line's datum, without irregularity.
  VectorXd height;
  VectorXd tension;    // N, of the droppers at mid-length; below 0 by stiffness times the gap of one that hangs loose
  VectorXd length;     // m, of the droppers, between the wires
  VectorXd stiffness;  // N/m, of the droppers
  VectorXd slack;      // m, by which droppers hang loose, as a LineState has it
};

// The contact wire hangs at its prescribed height at every dropper and under its own weight between them; what it
// takes to hold it there is what the droppers carry. The messenger hangs under its own weight and theirs, at its
// heights over supports and anchors: whatever a support gives way is built in. The steady arms carry nothing. Then
// droppers of other lengths find their equilibrium with the wires, held at the same places; some may hang loose in it.
// Throws Refusal where a dropper has no length, or would have to push, unless lengths are given in place of heights.
StaticShape static_shape(const Parameters& p, const LineTable& line, const Mesh& mesh, const Matrices& matrices);

}  // namespace zspring::catenary
