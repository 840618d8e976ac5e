// The model that the FMI layer is compiled for: the overhead line.
#pragma once

#include "catenary/simulation.hpp"

namespace zspring::fmi {
using catenary::Calculated;
using catenary::Inputs;
using catenary::Parameters;
using catenary::Simulation;
using Table = catenary::LineTable;
}  // namespace zspring::fmi
