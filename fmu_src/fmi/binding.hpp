// Ties each parameter, calculated parameter and input of a model description to the member of the model that it
// stands for. A variable without a line in the model's bindings.hpp does not compile, nor does a line without a
// variable or of another causality. Outputs have their definitions in the model, common/outputs.hpp.
//
// The FMI layer is compiled once for each model, with the folder of the model's bindings.hpp and variables.inc on
// the include path. In namespace zspring::fmi a model provides the types Parameters, Inputs (of Signals, with a
// visit), Calculated, and Simulation, a Model of these (common/model.hpp).
#pragma once

#include <type_traits>

#include "common/model.hpp"
#include "common/signal.hpp"

namespace zspring::fmi {

static_assert(std::is_base_of_v<Model<Parameters, Inputs>, Simulation> &&
              std::is_constructible_v<Simulation, const Parameters&, const Inputs&> &&
              std::is_same_v<decltype(std::declval<Simulation>().calculated()), const Calculated&>);

// How to reach a variable, element i of an array; null for what it is not. Every type passes as double, exact for
// what occurs.
struct Binding {
  double (*parameter)(const Parameters&, int i) = nullptr;
  void (*set_parameter)(Parameters&, int i, double) = nullptr;
  double (*calculated)(const Calculated&, int i) = nullptr;
  Signal& (*input)(Inputs&, int i) = nullptr;
};

inline void assign(double& member, double x) { member = x; }
inline void assign(int& member, double x) { member = static_cast<int>(x); }
template <class Enum>
void assign(Enum& member, double x) {
  member = static_cast<Enum>(static_cast<int>(x));
}

template <Id id>
constexpr Binding bind() {
  static_assert(kind_of(id).causality == Causality::Output, "bindings.hpp lacks a variable");
  return {};
}

}  // namespace zspring::fmi

#define ZSPRING_BINDING(id, kind, ...)                                                            \
  template <>                                                                                     \
  constexpr Binding bind<Id::id>() {                                                              \
    static_assert(kind_of(Id::id).causality == Causality::kind, #id ": is of another causality"); \
    Binding b;                                                                                    \
    __VA_ARGS__                                                                                   \
    return b;                                                                                     \
  }
#define PARAMETER(id, member)                                                                                  \
  ZSPRING_BINDING(                                                                                             \
      id, Parameter,                                                                                           \
      b.parameter = [](const Parameters& p, [[maybe_unused]] int i) { return static_cast<double>(p.member); }; \
      b.set_parameter = [](Parameters& p, [[maybe_unused]] int i, double x) { assign(p.member, x); };)
#define CALCULATED(id, member) \
  ZSPRING_BINDING(             \
      id, CalculatedParameter, \
      b.calculated = [](const Calculated& c, [[maybe_unused]] int i) -> double { return c.member; };)
#define INPUT(id, member) \
  ZSPRING_BINDING(id, Input, b.input = [](Inputs& u, [[maybe_unused]] int i) -> Signal& { return u.member; };)
