// The four degrees of freedom of a station at once, as vector instructions take them.
//
// Operations go element by element, in the order in which they are written, so that results have the same bits with
// vectors of two numbers, of four, and without any. Not a library's, as the sweeps (sweeps.cpp) are compiled for two
// kinds of processors, and a linker would keep one function of a template for both.
#pragma once

#include <cstring>

namespace zspring::catenary {

#if defined(__GNUC__)
#define ZSPRING_INLINE inline __attribute__((always_inline))
#pragma GCC diagnostic ignored "-Wpsabi"  // of functions that are always inlined

typedef double Four __attribute__((vector_size(32)));

ZSPRING_INLINE Four four(double x) { return Four{x, x, x, x}; }
// (w, w') of each wire exchanged.
ZSPRING_INLINE Four exchanged(const Four& x) {
#if defined(__clang__)
  return __builtin_shufflevector(x, x, 1, 0, 3, 2);
#else
  typedef long long Places __attribute__((vector_size(32)));
  return __builtin_shuffle(x, Places{1, 0, 3, 2});
#endif
}

#else
#define ZSPRING_INLINE inline

struct Four {
  double x[4];
  double operator[](int i) const { return x[i]; }
};
inline Four operator+(const Four& a, const Four& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]}; }
inline Four operator-(const Four& a, const Four& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]}; }
inline Four operator*(const Four& a, const Four& b) { return {a[0] * b[0], a[1] * b[1], a[2] * b[2], a[3] * b[3]}; }
inline Four four(double x) { return {x, x, x, x}; }
inline Four exchanged(const Four& x) { return {x[1], x[0], x[3], x[2]}; }
#endif

ZSPRING_INLINE Four load(const double* from) {
  Four x;
  std::memcpy(&x, from, sizeof x);
  return x;
}
ZSPRING_INLINE void store(double* to, const Four& x) { std::memcpy(to, &x, sizeof x); }
ZSPRING_INLINE double sum(const Four& x) { return (x[0] + x[1]) + (x[2] + x[3]); }

}  // namespace zspring::catenary
