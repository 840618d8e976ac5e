// The table of variables, generated from modelDescription.xml. Each parameter, calculated parameter and input
// stands for the member of the model's struct that has its name, and does not compile without it. Outputs have
// their definitions in the model, common/outputs.hpp.
//
// The FMI layer is compiled once for each model, with the folder of the model's model.hpp and variables.inc on the
// include path. In namespace zspring::fmi that provides the structs Parameters, Inputs (of Signals) and
// Calculated, and Simulation, a Model of these, with its Table (common/model.hpp).
#pragma once

#include <algorithm>
#include <cmath>
#include <iterator>
#include <type_traits>

#include "common/signal.hpp"
#include "model.hpp"

namespace zspring::fmi {

enum class Type { Real, Integer, Boolean, Enumeration };
enum class Causality { Parameter, CalculatedParameter, Input, Output };

// How to reach a variable; null for what it is not. Every type passes as double, exact for what occurs.
struct Binding {
  std::size_t size = 0;  // of the member
  double (*parameter)(const Parameters&) = nullptr;
  void (*set_parameter)(Parameters&, double) = nullptr;
  double (*calculated)(const Calculated&) = nullptr;
  Signal& (*input)(Inputs&) = nullptr;
  std::size_t output = 0;  // its place among the outputs
};
#define ZSPRING_MEMBER(Struct, member) std::remove_reference_t<decltype(std::declval<Struct&>().member)>
#define ZSPRING_Parameter(member)                                                                                 \
  {sizeof(ZSPRING_MEMBER(Parameters, member)), [](const Parameters& p) { return static_cast<double>(p.member); }, \
   [](Parameters& p, double x) { p.member = static_cast<ZSPRING_MEMBER(Parameters, member)>(x); }}
#define ZSPRING_CalculatedParameter(member) \
  {sizeof(double), nullptr, nullptr, [](const Calculated& c) { return c.member; }}
#define ZSPRING_Input(member) {sizeof(Signal), nullptr, nullptr, nullptr, [](Inputs& u) -> Signal& { return u.member; }}
#define ZSPRING_Output(place) {0, nullptr, nullptr, nullptr, nullptr, place}

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

  bool is_parameter() const { return causality == Causality::Parameter; }
  bool is_input() const { return causality == Causality::Input; }
  bool is_output() const { return causality == Causality::Output; }
  bool is_calculated() const { return !is_parameter() && !is_input(); }
  double get(const Parameters& p) const { return binding.parameter(p); }
  void set(Parameters& p, double x) const { binding.set_parameter(p, x); }
  double get(const Calculated& c) const { return binding.calculated(c); }
  Signal& signal(Inputs& u) const { return binding.input(u); }
  double get(const Outputs& y) const { return y[binding.output]; }
};

#define ZSPRING_ROW(name, type, causality, tunable, unit, start, min, max, allowed, member) \
  {name, Type::type, Causality::causality, tunable, unit, start, min, max, allowed, ZSPRING_##causality(member)},
inline constexpr Variable variables[] = {ZSPRING_VARIABLES(ZSPRING_ROW)};
inline constexpr unsigned variable_count = std::size(variables);  // value references are 0, 1, 2, ...

// The size of a struct with a member for each variable of this causality, in their order.
constexpr std::size_t size_of_all(Causality causality) {
  std::size_t end = 0;
  const auto align = [&](std::size_t size) { end = (end + size - 1) / size * size; };
  for (const Variable& v : variables) {
    if (v.causality != causality) continue;
    align(std::min(v.binding.size, sizeof(double)));
    end += v.binding.size;
  }
  align(sizeof(double));
  return end;
}
static_assert(size_of_all(Causality::Parameter) == sizeof(Parameters) &&
                  size_of_all(Causality::CalculatedParameter) == sizeof(Calculated) &&
                  size_of_all(Causality::Input) == sizeof(Inputs),
              "a member is no variable of the model description, or not in its order");

inline const char* type_name(Type t) {
  const char* names[] = {"Real", "Integer", "Boolean", "Enumeration"};
  return names[static_cast<int>(t)];
}

}  // namespace zspring::fmi
