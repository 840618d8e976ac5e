// Samples of a signal at communication points of any spacing, and the polynomial through the best of them.
#pragma once

#include <cmath>

#include "common/statistics.hpp"

namespace zspring {

// The newest ones, and before those ever fewer: for a step much longer than those before it there are samples as far
// apart as itself.
template <int kept_at_most>
struct Samples {
  static constexpr int most = kept_at_most, dense = 5;
  Count count = 0;
  double last_length = 0;    // s, of the last append
  double closest = 0;        // s, a neighbour nearer to the newest one tells nothing
  double age[most] = {};     // s before the newest sample, ascending, age[0] = 0
  double value[most] = {};   // SI, where the step that led there said it would end
  double length[most] = {};  // s, of that step where it followed derivatives; 0: it went to its target
  double missed[most] = {};  // by how much the next step began elsewhere

  // `step` s after the last one, following derivatives over `told` of it, all or nothing. Where steps are uneven, those
  // closer than `resolved` s are not kept as neighbours.
  void append(double step, double x, double resolved, double told = 0) {
    const bool even = std::abs(step - last_length) <= 1e-6 * step;
    const int replaced = count >= 2 && !even && age[1] < resolved ? 1 : 0;
    int kept = static_cast<int>(count) - replaced;
    if (kept == most) {
      if (most > dense && age[most - 1] <= 4 * age[most - 2]) remove(sparest(step));
      --kept;
    }
    for (int i = kept; i > 0; --i) move(i - 1 + replaced, i, step);
    age[0] = 0;
    value[0] = x;
    length[0] = told;
    missed[0] = 0;
    last_length = step;
    closest = even ? 0 : resolved;
    count = kept + 1;
  }

  // The next step begins at `x`. A very short one says nothing of by how much steps miss.
  void begin_at(double x) {
    missed[0] = x - value[0];
    if (count < 2 || length[0] >= closest / 16) return;
    value[0] = x - missed[1];
    missed[0] = missed[1];
    length[0] = length[1];
  }

  bool is_possible() const { return count <= most; }

 private:
  void move(int from, int to, double later) {
    age[to] = age[from] + later;
    value[to] = value[from];
    length[to] = length[from];
    missed[to] = missed[from];
  }
  void remove(int i) {
    for (; i + 1 < most; ++i) move(i + 1, i, 0);
  }
  // That which leaves the smallest gap for its age, `step` s from now; all are there.
  int sparest(double step) const {
    int found = dense - 1;
    for (int i = dense; i + 1 < most; ++i)
      if ((age[i + 1] - age[i - 1]) * (age[found] + step) < (age[found + 1] - age[found - 1]) * (age[i] + step))
        found = i;
    return found;
  }
};
using Positions = Samples<8>;
using Curvatures = Samples<4>;
ZSPRING_MEMBERS(Positions, count, last_length, closest, age, value, length, missed)
ZSPRING_MEMBERS(Curvatures, count, last_length, closest, age, value, length, missed)

// Newton's divided differences of the newest sample and older ones; linear in the values. Which ones is a matter of
// their times alone: the first at least `nearest` s old, each other at least half of that from the one before.
class Interpolant {
 public:
  static constexpr int most = 5;

  template <class Samples>
  Interpolant(const Samples& s, double nearest, int points = most) {
    int n = 0;
    double apart = nearest;
    for (int i = 0; i < static_cast<int>(s.count) && n < points; ++i) {
      if (i > 0 && s.age[i] + t_[n - 1] < apart) continue;
      // Much shorter steps tell too little of by how much this one misses.
      if (n > 1 && s.length[i] > 0 && s.length[0] > 4 * s.length[i]) break;
      t_[n] = -s.age[i];
      c_[n] = s.value[i];
      index_[n] = i;
      if (++n == 2) apart = s.age[i] / 2;
    }
    const double bend = even_out(s, n);
    for (int k = 1; k < n; ++k)
      for (int i = n - 1; i >= k; --i) c_[i] = (c_[i] - c_[i - 1]) / (t_[i] - t_[i - k]);
    if (n == 2) c_[2] = bend;
  }

  bool has_older() const { return t_[1] < 0; }
  // `tau` s after the newest sample.
  double value(double tau) const {
    double p = c_[most - 1];
    for (int i = most - 2; i >= 0; --i) p = c_[i] + (tau - t_[i]) * p;
    return p;
  }
  // At the newest sample: fourth and third order through five samples.
  double slope() const { return c_[1] - t_[1] * (c_[2] - t_[2] * (c_[3] - t_[3] * c_[4])); }
  double curvature() const {
    return 2 * (c_[2] - (t_[1] + t_[2]) * c_[3] + (t_[1] * t_[2] + t_[1] * t_[3] + t_[2] * t_[3]) * c_[4]);
  }

 private:
  // Steps of h s that follow a rate miss the next value by a h^2 / 2 - j h^3 / 3, with acceleration a and jerk j at
  // their end. Those of different lengths are made to miss as the newest does, of which it is not yet known; else the
  // difference would pass for an acceleration.
  template <class Samples>
  double even_out(const Samples& s, int n) {
    const double h = s.length[0];
    double bend = 0, jerk = 0;  // bend: missed / h^2
    for (int k = n - 1; k > 0; --k) {
      const int i = index_[k];
      const double own = s.length[i], before = bend;
      if (!(own > 0 && h > 0)) continue;
      bend = s.missed[i] / (own * own);
      if (k < n - 1) {
        const double apart = t_[k] - t_[k + 1], span = apart / 2 - (own - s.length[index_[k + 1]]) / 3;
        if (span > 0.1 * apart) jerk = (bend - before) / span;
      }
      c_[k] += s.missed[i] * (1 - (h / own) * (h / own)) - jerk * h * h * (own - h) / 3;
    }
    return bend;
  }

  int index_[most] = {};
  double t_[most] = {}, c_[most] = {};
};

}  // namespace zspring
