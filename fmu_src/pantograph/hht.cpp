#include "hht.hpp"

#include <algorithm>
#include <cmath>

namespace zspring {
namespace {

// Gauss elimination without pivoting, in place of Eigen's PartialPivLU, with which a step costs 9 to 12 % more
// (measured in pairs of runs of the standard figure). It needs none: the matrix is that of a positive definite one
// with its rod columns scaled by dw/dz >= 0 and ds/dz >= 0 added to their diagonal, so every pivot is positive.
// One that is not tells that the step is too large for the stiffness met, and the caller halves it.
template <int n>
bool eliminate(double (&A)[n][n], double (&x)[n]) {
  double inverse[n];
  for (int k = 0; k < n; ++k) {
    if (!(A[k][k] > 0)) return false;
    inverse[k] = 1 / A[k][k];
    for (int i = k + 1; i < n; ++i) {
      const double factor = A[i][k] * inverse[k];
      for (int j = k + 1; j < n; ++j) A[i][j] -= factor * A[k][j];
      x[i] -= factor * x[k];
    }
  }
  for (int k = n - 1; k >= 0; --k) {
    for (int j = k + 1; j < n; ++j) x[k] -= A[k][j] * x[j];
    x[k] *= inverse[k];
  }
  return true;
}

// The slopes of tanh(y) that the literature tries: exact sech^2(y), secant tanh(y)/y, their mean.
double tanh_slope(Tangent tangent, double y) {
  const double t = std::tanh(y);
  const double exact = (1 - t) * (1 + t);
  const double secant = std::abs(y) < 1e-5 ? 1 - y * y / 3 : t / y;
  if (tangent == Tangent::Exact) return exact;
  return tangent == Tangent::Secant ? secant : 0.5 * (exact + secant);
}

}  // namespace

StepCoefficients::StepCoefficients(const Mechanics& m, double step)
    : HhtCoefficients(m.parameters.solver.hht_alpha, step) {
  const Parameters& p = m.parameters;
  // Any rho > 0 solves the same step; this one gives J a diagonal of about weight * moment_bound.
  for (int j = 0; j < 2; ++j) {
    const int i = joint_dof[j];
    const double rho = (m.mass[i] + weight * beta_h2 * m.static_tangent(i, i)) / (gamma_h * weight * m.moment_bound[j]);
    joint[j] = JointScale(rho, p.zspring.tau);
  }
  inverse_h = 1 / h;
  inverse_gamma_h = 1 / gamma_h;
  coupling = -weight * (gamma_h * p.c2 + beta_h2 * p.k2);
  lower_inverse = 1 / (m.mass[U3] + weight * (gamma_h * (p.c2 + p.c3) + beta_h2 * (p.k2 + p.k3)));
  lower_share = coupling * lower_inverse;
}

Contact Hht::contact(const Boundary& b, double u, double v) const {
  const Parameters& p = m_.parameters;
  if (p.drive == Drive::Force) return {b.contact_force, true};
  const double force = p.static_force + p.contact.k * (u - b.position) + p.contact.c * (v - b.velocity);
  return force > 0 ? Contact{force, true} : Contact{0, false};
}

void Hht::predict(const StepCoefficients& c, const MechanicalState& from, Trial& t) const {
  for (int i = 0; i < 5; ++i) {
    t.q0[i] = from.q[i] + c.h * from.v[i] + c.old_position * from.a[i];
    t.v0[i] = from.v[i] + c.old_velocity * from.a[i];
  }
}

template <bool imposed, FrictionLaw law, bool direct>
bool Hht::evaluate(const StepCoefficients& c, const Boundary& b1, Trial& t) const {
  const Parameters& p = m_.parameters;
  const auto follow = [&](int i) {
    t.v[i] = t.v0[i] + c.gamma_h * t.a[i];
    t.q[i] = t.q0[i] + c.beta_h2 * t.a[i];
  };
  for (int i : mass_dof) {
    t.a[i] = t.x[i];
    follow(i);
  }
  if (imposed) {
    t.a[U1] = b1.acceleration;
    t.v[U1] = b1.velocity;
    t.q[U1] = b1.position;
  }
  for (int j = 0; j < 2; ++j) {
    const int i = joint_dof[j];
    if (direct) {
      t.a[i] = t.x[i];
      follow(i);
      const double y = p.zspring.tau * t.v[i];
      t.s[j] = std::tanh(y);
      t.angle_slope[j] = c.beta_h2;
      t.acceleration_slope[j] = 1;
      t.moment_slope[j] = c.gamma_h * p.zspring.tau * tanh_slope(p.solver.tangent, y);
    } else {
      const Resolvent r = resolvent<law>(c.joint[j], t.x[i], t.v[i]);
      t.v[i] = r.w;
      t.a[i] = (r.w - t.v0[i]) * c.inverse_gamma_h;
      t.q[i] = t.q0[i] + c.beta_h2 * t.a[i];
      t.s[j] = r.s;
      t.acceleration_slope[j] = r.dw_dz * c.inverse_gamma_h;
      t.angle_slope[j] = c.beta_h2 * t.acceleration_slope[j];
      t.moment_slope[j] = r.ds_dz;
    }
  }
  if (!m_.head_response(t.q, t.head)) return false;
  const Vector5 springs = m_.spring_force(t.q, t.head), dampers = m_.damping_force(t.v);
  for (int i = 0; i < 5; ++i) t.internal[i] = springs[i] + dampers[i];
  for (int j = 0; j < 2; ++j) t.internal[joint_dof[j]] += m_.moment_bound[j] * t.s[j];
  if (!imposed) t.contact = contact(b1, t.q[U1], t.v[U1]);
  return true;
}

// The lower frame couples to the upper one only and is eliminated first; an imposed head does not move.
template <bool imposed>
bool Hht::solve(const StepCoefficients& c, const Trial& t, Vector5& r) const {
  const Parameters& p = m_.parameters;
  const double gw = c.weight * c.gamma_h, bw = c.weight * c.beta_h2;
  constexpr int first = imposed ? ALPHA : U1, n = U3 - first, upper = U2 - first;
  // Column of a joint: its angle moves the spring, its moment stands on the diagonal alone.
  const double columns[] = {bw, c.weight * t.angle_slope[0], c.weight * t.angle_slope[1], bw};
  Matrix4 tangent;
  m_.head_tangent(t.head, tangent);
  double A[n][n], x[n];
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) A[i][j] = columns[first + j] * tangent(first + i, first + j);
    x[i] = r[first + i];
  }
  for (int j = 0; j < 2; ++j) {
    const int i = joint_dof[j];
    A[i - first][i - first] += m_.mass[i] * t.acceleration_slope[j] + c.weight * m_.moment_bound[j] * t.moment_slope[j];
  }
  A[upper][upper] += m_.mass[U2] + gw * (p.c1 + p.c2) + bw * p.k2 - c.coupling * c.lower_share;
  x[upper] -= c.lower_share * r[U3];
  if constexpr (!imposed) {
    A[U1][U1] += m_.mass[U1] + gw * p.c1;
    A[U1][upper] -= gw * p.c1;
    A[upper][U1] -= gw * p.c1;
    if (p.drive == Drive::Wire && t.contact.closed) A[U1][U1] += gw * p.contact.c + bw * p.contact.k;
  }
  if (!eliminate(A, x)) return false;
  r[U3] = r[U3] * c.lower_inverse - c.lower_share * x[upper];
  if (imposed) r[U1] = 0;
  for (int i = 0; i < n; ++i) r[first + i] = x[i];
  return true;
}

double Hht::reaction(const Boundary& b, const Vector5& internal) const {
  return b.uplift[0] - m_.mass[U1] * (b.acceleration + b.acceleration_change) - internal[U1];
}

double Hht::head_acceleration(const MechanicalState& s) const {
  if (head_imposed()) return s.boundary.acceleration + s.boundary.acceleration_change;
  return (s.boundary.uplift[0] - s.internal[U1] - s.contact_force) / m_.mass[U1];
}

Vector5 Hht::acceleration(const MechanicalState& s) const {
  Vector5 a = on_masses(s.boundary.uplift) - s.internal;
  for (int i = 0; i < 5; ++i) a[i] = m_.mass[i] > 0 ? a[i] / m_.mass[i] : s.a[i];
  a[U1] = head_acceleration(s);
  return a;
}

Vector5 Hht::push(const Boundary& b, double contact_force) const {
  Vector5 f = on_masses(b.uplift);
  f[U1] -= contact_force;
  if (head_imposed()) f[U1] -= m_.mass[U1] * b.acceleration_change;
  return f;
}

// The size of the forces that a step balances, N; of moments with the lengths of the rods. An imposed head balances
// none: where the position jumps, its reaction may be far larger than all others. The last term lifts the tolerance
// above rounding for very stiff springs.
double Hht::force_scale(const MechanicalState& from) const {
  const ZSpringParameters& z = m_.parameters.zspring;
  double inner = 0, inertia = 0;
  for (int i = 0; i < 5; ++i) {
    inner = std::max(inner, std::abs(from.internal[i]));
    if (i != U1 || !head_imposed()) inertia = std::max(inertia, m_.mass[i] * std::abs(from.a[i]));
  }
  return m_.load + (head_imposed() ? 0 : std::abs(from.contact_force)) + inner + inertia + 1e-6 * z.k * z.d;
}

template <bool imposed, FrictionLaw law, bool direct>
Convergence Hht::solve_step(const StepCoefficients& c, const MechanicalState& from, const Boundary& b1,
                            MechanicalState& to) const {
  const SolverParameters& solver = m_.parameters.solver;
  // What of the residual does not change: c.hht_alpha R0, and the forces from outside.
  double given[5];
  for (int i = 0; i < 5; ++i) given[i] = c.hht_alpha * from.internal[i];
  for (int k = 0; k < 3; ++k) given[mass_dof[k]] += c.weight * b1.uplift[k] - c.hht_alpha * from.boundary.uplift[k];
  if (!imposed) given[U1] += c.hht_alpha * contact(from.boundary, from.q[U1], from.v[U1]).force;
  const ZSpringParameters& z = m_.parameters.zspring;
  const double share = 1 / (solver.tolerance * force_scale(from));
  const double inverse[] = {share, share / z.L1, share / z.L2, share, share};  // of what is allowed to be unbalanced

  Trial t;
  predict(c, from, t);
  t.x = from.a;
  t.v = from.v;
  if (!direct)
    for (int j = 0; j < 2; ++j) t.x[joint_dof[j]] = c.joint[j].rho * from.v[joint_dof[j]] + from.s[j];

  Convergence end;
  end.residual = HUGE_VAL;
  bool small_change = false;
  Vector5 r;
  for (;; ++end.iterations) {
    if (!evaluate<imposed, law, direct>(c, b1, t)) return end;
    for (int i = 0; i < 5; ++i) r[i] = m_.mass[i] * t.a[i] + c.weight * t.internal[i] - given[i];
    r[U1] = imposed ? 0 : r[U1] + c.weight * t.contact.force;
    double worst = 0, nothing = 0;
    for (int i = 0; i < 5; ++i) {
      worst = std::max(worst, std::abs(r[i]) * inverse[i]);
      nothing += r[i] - r[i];
    }
    if (nothing != 0) return end;
    end.reached = small_change || worst <= 1;
    if (end.reached) break;
    if (end.iterations == solver.max_iterations || !solve<imposed>(c, t, r)) break;
    double change = 0, size = 0;
    for (int i = 0; i < 5; ++i) {
      t.x[i] -= r[i];
      double by = c.beta_h2 * r[i];
      if (i == ALPHA || i == BETA) {
        by = t.angle_slope[i - ALPHA] * r[i];
        // What the rate will be to first order: a guess for the next resolvent.
        if (!direct) t.v[i] -= c.gamma_h * t.acceleration_slope[i - ALPHA] * r[i];
      }
      change += by * by;
      size += t.q[i] * t.q[i];
    }
    size = solver.tolerance * (1 + std::sqrt(size));
    small_change = change <= size * size;
  }
  if (end.reached) {
    accept(c, from, b1, t, to);
  } else {
    for (int i = 0; i < 5; ++i)
      if (std::abs(r[i]) * inverse[i] > std::abs(r[end.dof]) * inverse[end.dof]) end.dof = i;
    end.residual = std::abs(r[end.dof]);
  }
  return end;
}

template <bool imposed>
const Hht::Variant& Hht::variant_of(const Mechanics& m) {
#define ZSPRING_VARIANT(law, direct)                                                                  \
  {                                                                                                   \
    &Hht::solve_step<imposed, law, direct>, &Hht::evaluate<imposed, law, false>, &Hht::solve<imposed> \
  }
  static constexpr Variant direct = ZSPRING_VARIANT(FrictionLaw::Tanh, true);
  static constexpr Variant laws[] = {
      ZSPRING_VARIANT(FrictionLaw::Free, false), ZSPRING_VARIANT(FrictionLaw::Tanh, false),
      ZSPRING_VARIANT(FrictionLaw::Coulomb, false), ZSPRING_VARIANT(FrictionLaw::Locked, false)};
#undef ZSPRING_VARIANT
  const bool is_direct = m.law == FrictionLaw::Tanh && m.parameters.solver.tangent != Tangent::Resolvent;
  return is_direct ? direct : laws[static_cast<int>(m.law)];
}

Hht::Hht(const Mechanics& mechanics)
    : m_(mechanics), variant_(head_imposed() ? &variant_of<true>(mechanics) : &variant_of<false>(mechanics)) {}

void Hht::accept(const StepCoefficients& c, const MechanicalState& from, const Boundary& b1, const Trial& t,
                 MechanicalState& to) const {
  to.q = t.q;
  to.v = t.v;
  to.a = t.a;
  to.a_slope = from.a_slope;
  if (tells_slope(c.h, from.h))
    for (int i = 0; i < 5; ++i) to.a_slope[i] = (t.a[i] - from.a[i]) * c.inverse_h;
  to.h = c.h;
  // A rod that sticks has no acceleration; HHT's own would ring and make it crawl.
  for (int j = 0; j < 2; ++j)
    if (t.angle_slope[j] == 0) to.a[joint_dof[j]] = to.a_slope[joint_dof[j]] = 0;
  to.s = t.s;
  to.internal = t.internal;
  to.contact_force = head_imposed() ? reaction(b1, t.internal) : t.contact.force;
  to.boundary = b1;

  to.loss_power = m_.damping_power(t.v);
  for (int j = 0; j < 2; ++j) to.loss_power += m_.moment_bound[j] * t.s[j] * t.v[joint_dof[j]];
  to.dissipated = from.dissipated + 0.5 * c.h * (from.loss_power + to.loss_power);
  const Vector5 push0 = push(from.boundary, from.contact_force), push1 = push(b1, to.contact_force);
  to.work = from.work;
  for (int i = 0; i < 5; ++i) to.work += (m_.preload[i] + 0.5 * (push0[i] + push1[i])) * (to.q[i] - from.q[i]);
}

}  // namespace zspring
