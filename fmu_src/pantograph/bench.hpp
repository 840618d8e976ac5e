// The built-in test bench: a response-controlled sine on the head and the first-order FRF of its answer.
//
// Displacement X sin(phase), X = acceleration / (2 pi f)^2. A change of frequency or acceleration starts a ramp
// that leads amplitude and frequency to their new values with continuous phase, position, velocity and
// acceleration, over about one period of the slower of the two, a whole number of the new ones; from then on whole
// periods are counted. The grid has a whole number of equal steps in each period, so that the trapezoidal rule
// over a period is exact for every harmonic that it resolves.
//
// H = -Z/F with Z, F the components of head displacement and contact force at f: minus because a positive
// contact force pushes down, so that the static phase is 0. Harmonics of the force are told as their peaks.
#pragma once

#include "state.hpp"

namespace zspring {

// Quintic p(s), s since the start, from given value, slope and curvature to a constant, reached after `length`.
struct Ramp {
  double c[6] = {};  // coefficients in x = s / length
  double length = 0;
  double end = 0;  // the constant

  struct Point {
    double value = 0, slope = 0, curvature = 0;
  };
  static Ramp to(double target, const Point& from, double length);
  Point at(double s) const;
  double integral(double s) const;
};
ZSPRING_MEMBERS(Ramp, c, length, end)

constexpr int harmonics = 7;  // of the contact force, the first included

struct BenchState {
  BenchParameters programme;  // its targets; frequency 0: none yet
  Ramp amplitude, speed;      // m; Hz
  double phase = 0;           // rad, where the ramp began
  double ramp_phase = 0;      // rad, where it ends
  Count steps_per_period = 0;
  double step = 0;  // s, of the grid
  Count ramp_steps = 0;
  Count node = 0;       // grid steps done since the ramp began
  Count in_period = 0;  // of these since the last whole period, or the ramp
  double offset = 0;    // s beyond that node, where a communication point cut a step
  double carry = 0;     // s, rounding left over by the last communication step
  // N, of the running period: twice the means of F cos^k and F sin cos^k of the phase, see finish_period
  double moments[harmonics + 1][2] = {};
  Count periods = 0;
  double H_re = 0, H_im = 0;  // m/N
  double change = 1;
  double harmonic[harmonics] = {};  // N, peaks in the last whole period

  bool is_possible(double largest_step) const;
};
ZSPRING_MEMBERS(BenchState, programme, amplitude, speed, phase, ramp_phase, steps_per_period, step, ramp_steps, node,
                in_period, offset, carry, moments, periods, H_re, H_im, change, harmonic)

// Internal steps in a period of the grid: the fewest whole number of at most `largest_step` s, 16 at least.
Count steps_in_period(double frequency, double largest_step);

struct Phasor {
  double sine, cosine;
};

class Bench {
 public:
  explicit Bench(BenchState& state) : b_(state) {}

  // Start a new programme if it differs from the running one.
  void tune(const BenchParameters& programme, double largest_step);
  // s, of the grid at this frequency
  static double grid_step(double frequency, double largest_step);
  double grid_step() const { return b_.step; }   // s
  double to_next_node() const;                   // s
  Phasor motion(double tau, Boundary& b) const;  // tau s from now
  // Move on by h s, a step that ends at the next node if `reaches_node`; phases and forces (N, less the static
  // one) at its begin and end.
  void advance(double h, bool reaches_node, Phasor begin, double force_begin, Phasor end, double force_end);

 private:
  double elapsed() const;           // s since the ramp began
  double phase_at(double s) const;  // rad
  void finish_period();

  BenchState& b_;
};

}  // namespace zspring
