#include "hht.hpp"

#include <cmath>

namespace zspring {
namespace {

// Gauss elimination without pivoting, in place of Eigen's PartialPivLU, with which a step costs 9 to 12 % more
// (measured in pairs of runs of the standard figure). It needs none: the matrix is that of a positive definite one
// with its rod columns scaled by dw/dz >= 0 and ds/dz >= 0 added to their diagonal, so every pivot is positive.
// One that is not tells that the step is too large for the stiffness met, and the caller halves it.
bool eliminate(Matrix4& A, Vector4& x) {
  for (int k = 0; k < 4; ++k) {
    if (!(A(k, k) > 0)) return false;
    const double inverse = 1 / A(k, k);
    for (int i = k + 1; i < 4; ++i) {
      const double factor = A(i, k) * inverse;
      for (int j = k + 1; j < 4; ++j) A(i, j) -= factor * A(k, j);
      x[i] -= factor * x[k];
    }
    A(k, k) = inverse;
  }
  for (int k = 3; k >= 0; --k) {
    for (int j = k + 1; j < 4; ++j) x[k] -= A(k, j) * x[j];
    x[k] *= A(k, k);
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
  // Any rho > 0 solves the same step; this one gives J a diagonal of about weight * moment_bound.
  for (int j = 0; j < 2; ++j) {
    const int i = joint_dof[j];
    rho[j] = (m.mass[i] + weight * beta_h2 * m.static_tangent(i, i)) / (gamma_h * weight * m.moment_bound[j]);
  }
}

Contact Hht::contact(const Boundary& b, double u, double v) const {
  const Parameters& p = m_.parameters;
  if (p.drive == Drive::Force) return {b.contact_force, true};
  const double force = p.static_force + p.contact.k * (u - b.position) + p.contact.c * (v - b.velocity);
  return force > 0 ? Contact{force, true} : Contact{0, false};
}

bool Hht::evaluate(const StepCoefficients& c, const MechanicalState& from, const Boundary& b1, bool direct,
                   Trial& t) const {
  const Parameters& p = m_.parameters;
  for (int i : mass_dof) {
    t.a[i] = t.x[i];
    t.v[i] = from.v[i] + c.old_velocity * from.a[i] + c.gamma_h * t.a[i];
    t.q[i] = from.q[i] + c.h * from.v[i] + c.old_position * from.a[i] + c.beta_h2 * t.a[i];
  }
  if (head_imposed()) {
    t.a[U1] = b1.acceleration;
    t.v[U1] = b1.velocity;
    t.q[U1] = b1.position;
  }
  for (int j = 0; j < 2; ++j) {
    const int i = joint_dof[j];
    const double v_predicted = from.v[i] + c.old_velocity * from.a[i];
    if (direct) {
      t.a[i] = t.x[i];
      t.v[i] = v_predicted + c.gamma_h * t.a[i];
      const double y = p.zspring.tau * t.v[i];
      t.s[j] = std::tanh(y);
      t.angle_slope[j] = c.beta_h2;
      t.acceleration_slope[j] = 1;
      t.moment_slope[j] = c.gamma_h * p.zspring.tau * tanh_slope(p.solver.tangent, y);
    } else {
      const Resolvent r = resolvent(m_.law, c.rho[j], p.zspring.tau, t.x[i], t.v[i]);
      t.v[i] = r.w;
      t.a[i] = (r.w - v_predicted) / c.gamma_h;
      t.s[j] = r.s;
      t.acceleration_slope[j] = r.dw_dz / c.gamma_h;
      t.angle_slope[j] = c.beta_h2 * t.acceleration_slope[j];
      t.moment_slope[j] = r.ds_dz;
    }
    t.q[i] = from.q[i] + c.h * from.v[i] + c.old_position * from.a[i] + c.beta_h2 * t.a[i];
  }
  const std::optional<ElementResponse> head = m_.head_response(t.q);
  if (!head) return false;
  t.head_tangent = head->tangent;
  t.internal = m_.spring_force(t.q, *head) + m_.damping_force(t.v);
  joints(t.internal) += m_.moment_bound.cwiseProduct(t.s);
  if (!head_imposed()) t.contact = contact(b1, t.q[U1], t.v[U1]);
  return true;
}

bool Hht::solve(const StepCoefficients& c, const Trial& t, Vector5& r) const {
  const Parameters& p = m_.parameters;
  const double gw = c.weight * c.gamma_h, bw = c.weight * c.beta_h2;
  // Column of a joint: its angle moves the spring, its moment stands on the diagonal alone.
  Matrix4 A;
  A.col(0) = bw * t.head_tangent.col(0);
  A.col(1) = c.weight * t.angle_slope[0] * t.head_tangent.col(1);
  A.col(2) = c.weight * t.angle_slope[1] * t.head_tangent.col(2);
  A.col(3) = bw * t.head_tangent.col(3);
  for (int j = 0; j < 2; ++j)
    A(j + 1, j + 1) += m_.mass[j + 1] * t.acceleration_slope[j] + c.weight * m_.moment_bound[j] * t.moment_slope[j];
  A(0, 0) += m_.mass[U1] + gw * p.c1;
  A(0, 3) -= gw * p.c1;
  A(3, 0) -= gw * p.c1;
  A(3, 3) += m_.mass[U2] + gw * (p.c1 + p.c2) + bw * p.k2;
  if (p.drive == Drive::Wire && t.contact.closed) A(0, 0) += gw * p.contact.c + bw * p.contact.k;

  // The lower frame couples to the upper one only.
  const double coupling = -(gw * p.c2 + bw * p.k2);
  const double lower = m_.mass[U3] + gw * (p.c2 + p.c3) + bw * (p.k2 + p.k3);
  A(3, 3) -= coupling * coupling / lower;
  Vector4 x = r.head<4>();
  x[3] -= coupling / lower * r[U3];
  if (head_imposed()) {
    A.row(0).setZero();
    A(0, 0) = 1;
    x[0] = 0;
  }
  if (!eliminate(A, x)) return false;
  r[U3] = (r[U3] - coupling * x[3]) / lower;
  r.head<4>() = x;
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

// The size of the forces that a step balances, N and N m. An imposed head balances none: where the position jumps, its
// reaction may be far larger than all others. The last term lifts the tolerance above rounding for very stiff springs.
Vector5 Hht::residual_scale(const MechanicalState& from) const {
  const ZSpringParameters& z = m_.parameters.zspring;
  Vector5 inertia = m_.mass.cwiseProduct(from.a);
  if (head_imposed()) inertia[U1] = 0;
  const double force = m_.load + (head_imposed() ? 0 : std::abs(from.contact_force)) +
                       from.internal.cwiseAbs().maxCoeff() + inertia.cwiseAbs().maxCoeff() + 1e-6 * z.k * z.d;
  Vector5 scale;
  scale << force, force * z.L1, force * z.L2, force, force;
  return scale;
}

Convergence Hht::step(const MechanicalState& from, const Boundary& b1, double h, MechanicalState& to) const {
  const StepCoefficients c(m_, h);
  const SolverParameters& solver = m_.parameters.solver;
  const bool direct = m_.law == FrictionLaw::Tanh && solver.tangent != Tangent::Resolvent;
  Vector5 R0 = from.internal - on_masses(from.boundary.uplift);
  if (!head_imposed()) R0[U1] += contact(from.boundary, from.q[U1], from.v[U1]).force;
  const Vector5 uplift = on_masses(b1.uplift);
  const Vector5 allowed = solver.tolerance * residual_scale(from);

  Trial t;
  t.x = from.a;
  t.v = from.v;
  if (!direct) joints(t.x) = c.rho.cwiseProduct(joints(from.v)) + from.s;

  Convergence end;
  end.residual = HUGE_VAL;
  bool small_change = false;
  for (;; ++end.iterations) {
    if (!evaluate(c, from, b1, direct, t)) break;
    Vector5 r = m_.mass.cwiseProduct(t.a) + c.weight * (t.internal - uplift) - c.hht_alpha * R0;
    if (head_imposed())
      r[U1] = 0;
    else
      r[U1] += c.weight * t.contact.force;
    const double worst = r.cwiseAbs().cwiseQuotient(allowed).maxCoeff(&end.dof);
    end.residual = std::abs(r[end.dof]);
    if (!r.allFinite()) break;
    end.reached = small_change || worst <= 1;
    if (end.reached || end.iterations == solver.max_iterations || !solve(c, t, r)) break;
    t.x -= r;
    Vector5 change = c.beta_h2 * r;
    joints(change) = t.angle_slope.cwiseProduct(joints(r));
    small_change = change.norm() <= solver.tolerance * (1 + t.q.norm());
  }
  if (end.reached) accept(c, from, b1, t, to);
  return end;
}

void Hht::accept(const StepCoefficients& c, const MechanicalState& from, const Boundary& b1, const Trial& t,
                 MechanicalState& to) const {
  to.q = t.q;
  to.v = t.v;
  to.a = t.a;
  to.a_slope = tells_slope(c.h, from.h) ? Vector5((t.a - from.a) / c.h) : from.a_slope;
  to.h = c.h;
  // A rod that sticks has no acceleration; HHT's own would ring and make it crawl.
  for (int j = 0; j < 2; ++j)
    if (t.angle_slope[j] == 0) to.a[joint_dof[j]] = to.a_slope[joint_dof[j]] = 0;
  to.s = t.s;
  to.internal = t.internal;
  to.contact_force = head_imposed() ? reaction(b1, t.internal) : t.contact.force;
  to.boundary = b1;

  to.loss_power = m_.damping_power(t.v);
  to.loss_power += m_.moment_bound.cwiseProduct(t.s).dot(joints(t.v));
  to.dissipated = from.dissipated + 0.5 * c.h * (from.loss_power + to.loss_power);
  const Vector5 mean_push = m_.preload + 0.5 * (push(from.boundary, from.contact_force) + push(b1, to.contact_force));
  to.work = from.work + mean_push.dot(to.q - from.q);
}

}  // namespace zspring
