#include "sweeps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "four.hpp"

#if defined(__GNUC__) && defined(__x86_64__)
#include <cpuid.h>
#endif

namespace zspring::catenary::sweeps {
namespace {

struct Block {
  Four straight, crossed;
};
ZSPRING_INLINE Block load(const StationRow::Block& b) {
  return {catenary::load(b.straight), catenary::load(b.crossed)};
}
ZSPRING_INLINE Four times(const Block& b, const Four& x) { return b.straight * x + b.crossed * exchanged(x); }
ZSPRING_INLINE Four times(const StationRow& row, const Four& before, const Four& here, const Four& after) {
  return times(load(row.before), before) + times(load(row.here), here) + times(load(row.after), after);
}
ZSPRING_INLINE Four times(const FactorBlock& m, const Four& x) {
  using catenary::load;
  const auto& c = m.column;
  return (load(c[0]) * four(x[0]) + load(c[1]) * four(x[1])) + (load(c[2]) * four(x[2]) + load(c[3]) * four(x[3]));
}

ZSPRING_INLINE void multiply_body(const StationRow* matrix, Range on, const double* x, double* y) {
  Four before = four(0), here = catenary::load(x + 4 * on.begin);
  for (int i = on.begin; i < on.end; ++i) {
    const Four after = i + 1 < on.end ? catenary::load(x + 4 * (i + 1)) : four(0);
    store(y + 4 * i, times(matrix[i], before, here, after));
    before = here, here = after;
  }
}

struct Predicted {
  Four strained, v;  // u + damping_stiffness v
};
struct Predictor {
  Four h, old_position, old_velocity, damping;
  const Predict& x;

  ZSPRING_INLINE Predicted at(int i) const {
    const int k = 4 * i;
    const Four v = catenary::load(x.v + k), a = catenary::load(x.a + k);
    const Four u1 = catenary::load(x.u + k) + h * v + old_position * a, v1 = v + old_velocity * a;
    store(x.u1 + k, u1);
    store(x.v1 + k, v1);
    return {u1 + damping * v1, v1};
  }
};

ZSPRING_INLINE void predict_body(const Operators& op, const HhtCoefficients& c, Range on, const Predict& x) {
  const Predictor predictor{four(c.h), four(c.old_position), four(c.old_velocity), four(op.damping_stiffness), x};
  const Four mass_damping = four(op.damping_mass), alpha = four(c.hht_alpha), weight = four(c.weight);
  Predicted before{four(0), four(0)}, here = predictor.at(on.begin);
  for (int i = on.begin; i < on.end; ++i) {
    const Predicted after = i + 1 < on.end ? predictor.at(i + 1) : Predicted{four(0), four(0)};
    const Four force = times(op.wires[i], before.strained, here.strained, after.strained) +
                       mass_damping * times(op.mass[i], before.v, here.v, after.v);
    store(x.right + 4 * i, alpha * catenary::load(x.internal + 4 * i) - weight * force);
    before = here, here = after;
  }
}

ZSPRING_INLINE bool correct_body(const Operators& op, const HhtCoefficients& c, Range on, const Correct& x) {
  const Four beta_h2 = four(c.beta_h2), gamma_h = four(c.gamma_h);
  const Four memory = four(c.hht_alpha / c.weight), inverse = four(1 / c.weight), rate = four(1 / c.h);
  Four nothing = four(0);
  Four before = four(0), here = catenary::load(x.a + 4 * on.begin);
  for (int i = on.begin; i < on.end; ++i) {
    const int k = 4 * i;
    const Four after = i + 1 < on.end ? catenary::load(x.a + k + 4) : four(0);
    store(x.u1 + k, catenary::load(x.u1 + k) + beta_h2 * here);
    store(x.v1 + k, catenary::load(x.v1 + k) + gamma_h * here);
    const Four internal = memory * catenary::load(x.internal + k) - inverse * times(op.mass[i], before, here, after);
    store(x.internal1 + k, internal);
    if (x.slope) store(x.slope + k, rate * (here - catenary::load(x.old_a + k)));
    nothing = nothing + (here - here) + (internal - internal);
    before = here, here = after;
  }
  return sum(nothing) == 0;
}

ZSPRING_INLINE Products account_body(const Operators& op, Range on, const Account& x) {
  const Four stiffness_damping = four(op.damping_stiffness), mass_damping = four(op.damping_mass);
  Four v_mass_v = four(0), old_v_damping = four(0), v_damping = four(0), u_internal = four(0), u_damping = four(0);
  Four before = four(0), here = catenary::load(x.v + 4 * on.begin);
  for (int i = on.begin; i < on.end; ++i) {
    const int k = 4 * i;
    const Four after = i + 1 < on.end ? catenary::load(x.v + k + 4) : four(0);
    const Four momentum = times(op.mass[i], before, here, after), u = catenary::load(x.u + k);
    const Four damping = stiffness_damping * times(op.wires[i], before, here, after) + mass_damping * momentum;
    store(x.damping + k, damping);
    v_mass_v = v_mass_v + here * momentum;
    old_v_damping = old_v_damping + catenary::load(x.old_v + k) * damping;
    v_damping = v_damping + here * damping;
    u_internal = u_internal + u * catenary::load(x.internal + k);
    u_damping = u_damping + u * damping;
    before = here, here = after;
  }
  return {sum(v_mass_v), sum(old_v_damping), sum(v_damping), sum(u_internal), sum(u_damping)};
}

ZSPRING_INLINE void solve_body(const Factor& f, double* x) {
  Four last = catenary::load(x);
  for (int i = 1; i < f.stations; ++i) {
    last = catenary::load(x + 4 * i) - times(f.forward[i], last);
    store(x + 4 * i, last);
  }
  last = four(0);
  for (int i = f.stations - 1; i >= 0; --i) {
    last = times(f.inverse[i], catenary::load(x + 4 * i)) - times(f.backward[i], last);
    store(x + 4 * i, last);
  }
}

ZSPRING_INLINE double largest(const Four& x) {
  return std::max(std::max(std::abs(x[0]), std::abs(x[1])), std::max(std::abs(x[2]), std::abs(x[3])));
}

ZSPRING_INLINE Range solve_locally_body(const Factor& f, Range on, double* x) {
  constexpr double negligible = 1e-2 * std::numeric_limits<double>::epsilon();
  Four last = four(0);
  double most = 0;
  int end = on.begin;
  for (; end < f.stations; ++end) {
    last = catenary::load(x + 4 * end) - times(f.forward[end], last);
    most = std::max(most, largest(last));
    if (end >= on.end && largest(last) <= negligible * most) break;
    store(x + 4 * end, last);
  }
  last = four(0);
  most = 0;
  int begin = end;
  for (; begin > 0; --begin) {
    const int i = begin - 1;
    const Four right = i >= on.begin ? catenary::load(x + 4 * i) : four(0);
    last = times(f.inverse[i], right) - times(f.backward[i], last);
    most = std::max(most, largest(last));
    if (i < on.begin && largest(last) <= negligible * most) break;
    store(x + 4 * i, last);
  }
  return {begin, end};
}

// GCC for Windows moves what does not fit into registers as if the stack were aligned for AVX (GCC bug 54412).
#if defined(__GNUC__) && defined(__x86_64__) && (defined(__clang__) || !defined(_WIN32))
// Processor and system know AVX2. By hand, as __builtin_cpu_supports needs a runtime that zig does not bring.
bool knows_avx2() {
  unsigned a, b, c, d;
  constexpr unsigned saved_by_system = 1u << 27, avx = 1u << 28, avx2 = 1u << 5, xmm_and_ymm = 6;
  if (!__get_cpuid(1, &a, &b, &c, &d) || (c & (saved_by_system | avx)) != (saved_by_system | avx)) return false;
  unsigned low, high;
  __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
  if ((low & xmm_and_ymm) != xmm_and_ymm) return false;
  return __get_cpuid_count(7, 0, &a, &b, &c, &d) && (b & avx2);
}
const bool has_avx2 = knows_avx2();
#define ZSPRING_SWEEP(Result, name, parameters, arguments)                                        \
  Result name##_any parameters { return name##_body arguments; }                                  \
  __attribute__((target("avx2"))) Result name##_avx2 parameters { return name##_body arguments; } \
  }                                                                                               \
  Result name parameters { return has_avx2 ? name##_avx2 arguments : name##_any arguments; }      \
  namespace {
#else
#define ZSPRING_SWEEP(Result, name, parameters, arguments) \
  }                                                        \
  Result name parameters { return name##_body arguments; } \
  namespace {
#endif

ZSPRING_SWEEP(void, multiply, (const StationRow* matrix, Range on, const double* x, double* y), (matrix, on, x, y))
ZSPRING_SWEEP(void, predict, (const Operators& op, const HhtCoefficients& c, Range on, const Predict& x),
              (op, c, on, x))
ZSPRING_SWEEP(bool, correct, (const Operators& op, const HhtCoefficients& c, Range on, const Correct& x),
              (op, c, on, x))
ZSPRING_SWEEP(Products, account, (const Operators& op, Range on, const Account& x), (op, on, x))
ZSPRING_SWEEP(void, solve, (const Factor& f, double* x), (f, x))
ZSPRING_SWEEP(Range, solve_locally, (const Factor& f, Range on, double* x), (f, on, x))

}  // namespace
}  // namespace zspring::catenary::sweeps
