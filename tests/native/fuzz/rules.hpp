// What the standard says of a call: in which states it is allowed (FMI 2.0, table of section 4.2.4) and which
// values it may set. Written once more, apart from the FMU's own code, to hold that against it.
#pragma once

#include <cmath>
#include <vector>

#include "fmi/variables.hpp"
#include "fmi2Functions.h"

namespace fuzz {

using zspring::fmi::Causality;
using zspring::fmi::Type;
using zspring::fmi::Variable;
using zspring::fmi::variable_count;
using zspring::fmi::variables;

enum State { Instantiated, Initialization, StepComplete, StepFailed, Terminated, Failed };

inline bool is_readable(State s) { return s != Instantiated; }
inline bool is_settable(State s) { return s <= StepFailed; }
inline bool is_stepping(State s) { return s == StepComplete || s == StepFailed; }
inline bool has_stepped(State s) { return s >= StepComplete; }

inline bool is_input_or_parameter(const Variable& v) {
  return v.causality == Causality::Input || v.causality == Causality::Parameter;
}

inline Type asked_as(Type t) { return t == Type::Enumeration ? Type::Integer : t; }

// A variable of this reference, as this type.
inline bool exists(unsigned reference, Type type) {
  return reference < variable_count && asked_as(variables[reference].type) == type;
}

inline bool may_set(unsigned reference, Type type, State state, double x) {
  if (!is_settable(state) || !exists(reference, type)) return false;
  const Variable& v = variables[reference];
  const bool early = state == Instantiated || state == Initialization;
  const bool now = v.causality == Causality::Input || (v.causality == Causality::Parameter && (early || v.tunable));
  return now && std::isfinite(x) && x >= v.min && x <= v.max;
}

inline bool may_get_output_derivative(unsigned reference, int order) {
  return exists(reference, Type::Real) && variables[reference].causality == Causality::Output && order == 1;
}

inline bool may_set_input_derivative(unsigned reference, int order, double x) {
  return exists(reference, Type::Real) && variables[reference].causality == Causality::Input &&
         (order == 1 || order == 2) && std::isfinite(x);
}

inline bool may_be_unknown(unsigned reference) {
  return exists(reference, Type::Real) && !is_input_or_parameter(variables[reference]);
}

inline bool may_be_known(unsigned reference, double direction) {
  if (direction == 0 && reference < variable_count) return true;  // whatever its type
  return exists(reference, Type::Real) && variables[reference].causality == Causality::Input &&
         std::isfinite(direction);
}

}  // namespace fuzz
