// What a user reads, from the state; and how it changes with the state.
#pragma once

#include "common/outputs.hpp"
#include "line.hpp"

namespace zspring::catenary {

// What the definitions in outputs.cpp are written with.
struct View {
  View(const Line& overhead, const LineState& state);

  double dropper_force(int dropper) const;  // N

  const Line& line;
  const LineState& s;
  Place contact[pantographs], point[most_points];  // under the pantographs; watched
  Count slack = 0;                                 // droppers
  int weakest = 0, strongest = 0;                  // droppers
};

}  // namespace zspring::catenary
