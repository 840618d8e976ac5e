// Every output in one definition: its value and how it changes with the state. The change serves for the slope in
// time and for the derivatives with respect to inputs.
//
// In each model's outputs.cpp a variable of its model description has one of
//
//   OUTPUT(id, value, change)   a continuous Real
//   LINEAR(id, member)          the same, a member of the state: its change is that member of the variation
//   DISCRETE(id, value)         whatever counts, averages or switches: it has no change
//
// written with x, the model's view of its state, x.s the state itself, d a variation of that, and i, the index in
// an array. An output without a definition does not compile, nor does a continuous one without its change.
#pragma once

#include <array>

#include "variables.inc"

namespace zspring {

// One for each output or array of outputs.
#define ZSPRING_ENUMERATOR(id, continuous) id,
enum class Id { ZSPRING_IDENTIFIERS(ZSPRING_ENUMERATOR) };
#define ZSPRING_CONTINUOUS(id, continuous) continuous,
inline constexpr bool is_continuous[] = {ZSPRING_IDENTIFIERS(ZSPRING_CONTINUOUS)};
#define ZSPRING_ID(id, i) Id::id,
inline constexpr Id id_of[] = {ZSPRING_OUTPUTS(ZSPRING_ID)};  // an output, by its place

using Outputs = std::array<double, ZSPRING_OUTPUT_COUNT>;  // in the order of the model description

template <Id id, class View>
struct Output;  // see above

template <class View>
Outputs output_values(const View& x) {
#define ZSPRING_VALUE(id, i) static_cast<double>(Output<Id::id, View>::value(x, i)),
  return {ZSPRING_OUTPUTS(ZSPRING_VALUE)};
}

template <class View, class State>
Outputs output_changes(const View& x, const State& d) {
#define ZSPRING_CHANGE(id, i) Output<Id::id, View>::change(x, d, i),
  return {ZSPRING_OUTPUTS(ZSPRING_CHANGE)};
}

inline bool all_finite(const Outputs& y) {
  double sum = 0;
  for (double x : y) sum += x - x;
  return sum == 0;
}

}  // namespace zspring

#define ZSPRING_OUTPUT(id, has_change, value_of_x, change_with_d)                                                   \
  template <class View>                                                                                             \
  struct Output<Id::id, View> {                                                                                     \
    static_assert(is_continuous[static_cast<int>(Id::id)] == has_change, #id ": see common/outputs.hpp");           \
    static auto value([[maybe_unused]] const View& x, [[maybe_unused]] int i) { return value_of_x; }                \
    template <class State>                                                                                          \
    static double change([[maybe_unused]] const View& x, [[maybe_unused]] const State& d, [[maybe_unused]] int i) { \
      return change_with_d;                                                                                         \
    }                                                                                                               \
  };
#define OUTPUT(id, value_of_x, change_with_d) ZSPRING_OUTPUT(id, true, value_of_x, change_with_d)
#define LINEAR(id, member) OUTPUT(id, x.s.member, d.member)
#define DISCRETE(id, value_of_x) ZSPRING_OUTPUT(id, false, value_of_x, 0)
