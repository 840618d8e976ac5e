// What is done at every station of the line in a step: the only loops that cost time.
//
// Vectors have the four degrees of freedom of each station one after the other; beyond the stations that a sweep goes
// over they count as zero. A sweep may write over what it reads. Compiled for any processor and, on x86-64, for those
// with AVX2 as well, with the same bits.
#pragma once

#include "common/hht.hpp"

namespace zspring::catenary {

// Of stations, or of droppers.
struct Range {
  int begin, end;  // end: the one behind the last; both 0 of none

  int count() const { return end - begin; }
  bool empty() const { return begin == end; }
  Range with(Range other) const {
    if (empty() || other.empty()) return empty() ? other : *this;
    return {begin < other.begin ? begin : other.begin, end > other.end ? end : other.end};
  }
};

// The row of a station in a matrix that couples each wire to its neighbours alone: of (w, w') at a node, times a vector
// x of these, straight x + crossed (x with w and w' exchanged), for both wires.
struct StationRow {
  struct Block {
    double straight[4] = {}, crossed[4] = {};
  };
  Block before, here, after;  // with the last station, this and the next
};

struct FactorBlock {
  double column[4][4];
};

namespace sweeps {

struct Operators {
  const StationRow *wires, *mass;
  double damping_stiffness, damping_mass;  // C = damping_stiffness wires + damping_mass mass
};

// y = matrix x
void multiply(const StationRow* matrix, Range on, const double* x, double* y);

// Predictors u1 and v1 of the state after a step, and in `right` HHT's right side without springs and loads:
// hht_alpha internal - weight (wires u1 + C v1).
struct Predict {
  const double *u, *v, *a, *internal;
  double *u1, *v1, *right;
};
void predict(const Operators& op, const HhtCoefficients& c, Range on, const Predict& x);

// From the acceleration at the end of the step its displacement, velocity, internal forces less the contact forces and,
// unless null, the slope of the acceleration from `old_a`. Returns whether all of it is finite.
struct Correct {
  const double *a, *internal, *old_a;
  double *u1, *v1, *internal1, *slope;
};
bool correct(const Operators& op, const HhtCoefficients& c, Range on, const Correct& x);

// damping = C v, and the products that the energies are made of.
struct Account {
  const double *u, *v, *internal, *old_v;
  double* damping;
};
struct Products {
  double v_mass_v, old_v_damping, v_damping, u_internal, u_damping;
};
Products account(const Operators& op, Range on, const Account& x);

// The factor L D L' of a block tridiagonal matrix, for each station: D^-1, what L has before it, what L' has after it.
struct Factor {
  const FactorBlock *inverse, *forward, *backward;
  int stations;
};
// x -> A^-1 x
void solve(const Factor& f, double* x);
// The same where x is zero outside of `on`; returns the stations outside of which the solution is below rounding and x
// left zero.
Range solve_locally(const Factor& f, Range on, double* x);

}  // namespace sweeps
}  // namespace zspring::catenary
