// The table of variables, generated from modelDescription.xml, with the binding of each.
#pragma once

#include <cmath>

#include "bindings.hpp"

namespace zspring::fmi {

enum class Type { Real, Integer, Boolean, Enumeration };
enum class Causality { Parameter, CalculatedParameter, Input, Output };

struct Variable {
  const char* name;
  Type type;
  Causality causality;
  bool tunable;
  const char* unit;  // "" for none
  double start;      // 0 where the standard knows no start
  double min, max;
  const char* allowed;  // "1 Force, 2 Displacement, ..." of an enumeration
  Binding binding;
};

#define ZSPRING_ROW(id, name, type, causality, tunable, unit, start, min, max, allowed) \
  {name, Type::type, Causality::causality, tunable, unit, start, min, max, allowed, bind<vr::id>()},
inline constexpr Variable variables[] = {ZSPRING_VARIABLES(ZSPRING_ROW)};
#undef ZSPRING_ROW

inline const char* type_name(Type t) {
  const char* names[] = {"Real", "Integer", "Boolean", "Enumeration"};
  return names[static_cast<int>(t)];
}

}  // namespace zspring::fmi
