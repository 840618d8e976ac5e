// The model that the FMI layer is compiled for: the pantograph, whose types are in namespace zspring.
#pragma once

#include "pantograph/simulation.hpp"

namespace zspring::fmi {
using Table = NoTable;
}  // namespace zspring::fmi
