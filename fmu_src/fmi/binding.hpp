// Ties each variable of a model description to the member of the model that it stands for. A variable without a
// line in the model's bindings.hpp does not compile, nor does a line without a variable.
//
// The FMI layer is compiled once for each model, with the folder of the model's bindings.hpp and variables.inc on
// the include path. In namespace zspring::fmi a model provides the types Parameters, Inputs (of Signals), Outputs
// and Calculated, a visit(Inputs&, f), and the class Simulation: pantograph/simulation.hpp shows what it needs.
#pragma once

#include "variables.inc"

namespace zspring::fmi {

// One for each variable or array of variables.
#define ZSPRING_ENUMERATOR(id) id,
enum class Id { ZSPRING_IDENTIFIERS(ZSPRING_ENUMERATOR) };
#undef ZSPRING_ENUMERATOR

// How to reach a variable, element i of an array; null for what it is not. Every type passes as double, exact for
// what occurs.
struct Binding {
  double (*parameter)(const Parameters&, int i) = nullptr;
  void (*set_parameter)(Parameters&, int i, double) = nullptr;
  double (*calculated)(const Calculated&, int i) = nullptr;
  Signal& (*input)(Inputs&, int i) = nullptr;
  double (*output)(const Outputs&, int i) = nullptr;
};

inline void assign(double& member, double x) { member = x; }
inline void assign(int& member, double x) { member = static_cast<int>(x); }
template <class Enum>
void assign(Enum& member, double x) {
  member = static_cast<Enum>(static_cast<int>(x));
}

template <Id id>
Binding bind() = delete;  // see above

}  // namespace zspring::fmi

#define PARAMETER(id, member)                                                                                \
  template <>                                                                                                \
  constexpr Binding bind<Id::id>() {                                                                         \
    Binding b;                                                                                               \
    b.parameter = [](const Parameters& p, [[maybe_unused]] int i) { return static_cast<double>(p.member); }; \
    b.set_parameter = [](Parameters& p, [[maybe_unused]] int i, double x) { assign(p.member, x); };          \
    return b;                                                                                                \
  }
#define CALCULATED(id, member)                                                                     \
  template <>                                                                                      \
  constexpr Binding bind<Id::id>() {                                                               \
    Binding b;                                                                                     \
    b.calculated = [](const Calculated& c, [[maybe_unused]] int i) -> double { return c.member; }; \
    return b;                                                                                      \
  }
#define INPUT(id, member)                                                            \
  template <>                                                                        \
  constexpr Binding bind<Id::id>() {                                                 \
    Binding b;                                                                       \
    b.input = [](Inputs& u, [[maybe_unused]] int i) -> Signal& { return u.member; }; \
    return b;                                                                        \
  }
#define OUTPUT(id, member)                                                                  \
  template <>                                                                               \
  constexpr Binding bind<Id::id>() {                                                        \
    Binding b;                                                                              \
    b.output = [](const Outputs& y, [[maybe_unused]] int i) -> double { return y.member; }; \
    return b;                                                                               \
  }
