// The table of variables, generated from modelDescription.xml, with the binding of each.
#pragma once

#include <cmath>
#include <iterator>

#include "bindings.hpp"

namespace zspring::fmi {

enum class Type { Real, Integer, Boolean, Enumeration };

struct Variable {
  const char* name;
  int index;  // of an element in its array
  Type type;
  Causality causality;
  bool tunable;
  const char* unit;  // "" for none
  double start;      // 0 where the standard knows no start
  double min, max;
  const char* allowed;  // "1 Force, 2 Displacement, ..." of an enumeration
  int output;           // its place among the outputs, -1 for none
  Binding binding;

  bool is_parameter() const { return binding.parameter; }
  bool is_input() const { return binding.input; }
  bool is_output() const { return output >= 0; }
  double get(const Parameters& p) const { return binding.parameter(p, index); }
  void set(Parameters& p, double x) const { binding.set_parameter(p, index, x); }
  double get(const Calculated& c) const { return binding.calculated(c, index); }
  Signal& signal(Inputs& u) const { return binding.input(u, index); }
  double get(const Outputs& y) const { return y[static_cast<size_t>(output)]; }
};

#define ZSPRING_ROW(id, index, name, type, causality, tunable, unit, start, min, max, allowed, output) \
  {name, index, Type::type, Causality::causality, tunable, unit, start, min, max, allowed, output, bind<Id::id>()},
inline constexpr Variable variables[] = {ZSPRING_VARIABLES(ZSPRING_ROW)};
#undef ZSPRING_ROW
inline constexpr unsigned variable_count = std::size(variables);  // value references are 0, 1, 2, ...

inline const char* type_name(Type t) {
  const char* names[] = {"Real", "Integer", "Boolean", "Enumeration"};
  return names[static_cast<int>(t)];
}

}  // namespace zspring::fmi
