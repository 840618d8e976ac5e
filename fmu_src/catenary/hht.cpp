#include "hht.hpp"

#include <algorithm>
#include <cmath>

namespace zspring::catenary {
namespace {

double rounded(double h) {
  int exponent;
  const double mantissa = std::frexp(h, &exponent);
  return std::ldexp(std::round(std::ldexp(mantissa, 36)), exponent - 36);
}

// M + (1 + hht_alpha) (gamma h C + beta h^2 K)
SparseMatrix iteration_matrix(const Line& line, const HhtCoefficients& c) {
  const Parameters& p = line.p;
  return (1 + c.weight * c.gamma_h * p.damping.mass) * line.matrices.mass +
         c.weight * c.gamma_h * p.damping.stiffness * line.matrices.wires + c.weight * c.beta_h2 * line.stiffness();
}

}  // namespace

StepFactors::StepFactors(const Line& line, double step)
    : HhtCoefficients(line.p.solver.hht_alpha, step),
      factor(iteration_matrix(line, *this)),
      droppers(line.mesh, factor, weight * beta_h2) {}

Hht::Hht(const Line& line)
    : line_(line),
      wires_(line.matrices.wires),
      mass_(line.matrices.mass),
      mass_factor_(line.matrices.mass),
      slackening_(line.shape.stiffness),
      x_(line.mesh.dofs()),
      y_(line.mesh.dofs()),
      mv_(line.mesh.dofs()),
      ma_(line.mesh.dofs()),
      old_v_(line.mesh.dofs()),
      trial_(line.shape.stiffness.size()) {
  factors(line.p.solver.step);
}

const StepFactors& Hht::factors(double h) {
  const double wanted = rounded(h);
  auto* const end = std::end(factors_);
  auto* found = std::find_if(factors_, end, [&](const auto& f) { return !f || f->h == wanted; });
  if (found == end) --found;
  if (!*found || (*found)->h != wanted) *found = std::make_unique<StepFactors>(line_, wanted);
  std::rotate(factors_, found, found + 1);
  return *factors_[0];
}

// In trial_: the droppers' forces, N, at u + beta_h2 a if none were slack.
void Hht::trial_forces(const VectorXd& u, const VectorXd& a, double beta_h2) {
  const StaticShape& shape = line_.shape;
  for (int j = 0; j < static_cast<int>(trial_.size()); ++j)
    trial_[j] = shape.stiffness[j] * (stretch(line_.mesh, u, j) + beta_h2 * stretch(line_.mesh, a, j));
}

// What the slack droppers do to x, in units of `factor` over the response's.
void Hht::add_slack(const DropperResponse& response, double factor, const VectorXd& slack, VectorXd& x) const {
  for (int j = 0; j < static_cast<int>(slack.size()); ++j)
    if (slack[j] != 0) response.add(j, -factor * line_.shape.stiffness[j] * slack[j], x);
}

BlockCholesky Hht::static_factor() const {
  SparseMatrix stiffness = line_.stiffness();
  for (int dof = 0; dof < line_.mesh.dofs(); ++dof)
    if (is_anchor(line_.mesh, dof)) stiffness.coeffRef(dof, dof) = 1;
  return BlockCholesky(stiffness);
}

LineState Hht::at_rest_if_taut(const BlockCholesky& factor, const Loads& loads) const {
  LineState s = LineState::at_rest(line_);
  loads.add_to(s.u, 1);
  factor.solve(s.u);
  return s;
}

std::optional<LineState> Hht::at_rest(const Loads& loads) {
  const BlockCholesky factor = static_factor();
  LineState s = at_rest_if_taut(factor, loads);
  trial_forces(s.u, s.a, 0);
  trial_ += line_.shape.tension;
  if (trial_.size() > 0 && trial_.minCoeff() < 0) {
    const DropperResponse response(line_.mesh, factor, 1);
    if (!slackening_.solve(trial_, response.compliance(), s.slack)) return std::nullopt;
    add_slack(response, 1, s.slack, s.u);
  }
  wires_.multiply(s.u, x_);
  line_.add_springs(s.u, x_);
  s.elastic = 0.5 * (s.u.dot(x_) - s.slack.cwiseAbs2().dot(line_.shape.stiffness));
  return s;
}

LineState Hht::at_rest_variation(const Loads& dloads, const VectorXd& slack) {
  const BlockCholesky factor = static_factor();
  LineState d = at_rest_if_taut(factor, dloads);
  if (slack.size() > 0 && slack.maxCoeff() > 0) {
    const DropperResponse response(line_.mesh, factor, 1);
    trial_forces(d.u, d.a, 0);
    slackening_.solve_variation(trial_, response.compliance(), slack, d.slack);
    add_slack(response, 1, d.slack, d.u);
  }
  return d;
}

void Hht::jump(const Loads& l0, const Loads& l1, LineState& s) {
  if (l0 == l1) return;
  x_.setZero();
  l1.add_to(x_, 1);
  l0.add_to(x_, -1);
  s.internal -= x_;
  mass_factor_.solve(x_);
  s.a += x_;
}

// Leaves in s.u, s.v the predictors, in s.a the acceleration if no dropper were slack, in mv_ M times the
// predictor of v.
void Hht::predict(const StepFactors& f, const Loads& l1, LineState& s) {
  const Parameters& p = line_.p;
  s.u += f.h * s.v + f.old_position * s.a;
  s.v += f.old_velocity * s.a;
  y_ = s.u + p.damping.stiffness * s.v;
  wires_.multiply(y_, x_);
  line_.add_springs(s.u, x_);
  mass_.multiply(s.v, mv_);
  x_ += p.damping.mass * mv_;
  s.a = f.hht_alpha * s.internal - f.weight * x_;
  l1.add_to(s.a, f.weight);
  f.factor.solve(s.a);
}

// With what the slack droppers do: the state at the end of the step.
void Hht::correct(const StepFactors& f, LineState& s) {
  const double w = f.weight;
  add_slack(f.droppers, w, s.slack, s.a);
  s.u += f.beta_h2 * s.a;
  s.v += f.gamma_h * s.a;
  mass_.multiply(s.a, ma_);
  s.internal = (f.hht_alpha / w) * s.internal - (1 / w) * ma_;
}

bool Hht::step(const StepFactors& f, const Loads& l0, const Loads& l1, LineState& s, bool with_energies) {
  const Parameters& p = line_.p;
  const double work_before = with_energies ? l0.dot(s.u) + l1.dot(s.u) : 0;
  move_memory(f.hht_alpha, s.h, f.h, s.a_slope, s.a);
  const bool slope_known = tells_slope(f.h, s.h);
  if (slope_known) s.a_slope = s.a;
  if (with_energies) old_v_ = s.v;
  predict(f, l1, s);
  trial_forces(s.u, s.a, f.beta_h2);
  trial_ += line_.shape.tension;
  const std::optional<int> solved = slackening_.solve(trial_, f.droppers.compliance(), s.slack);
  if (!solved || !s.a.allFinite()) return false;
  correct(f, s);
  if (slope_known) s.a_slope = (s.a - s.a_slope) / f.h;
  s.h = f.h;
  s.statistics.steps += 1;
  s.statistics.add_attempt(*solved);
  if (!with_energies) return true;

  // Energies; mv_ becomes M v. The loss at the mean velocity: with hht_alpha = 0 and no change of the slack
  // droppers the energies then balance to rounding.
  mv_ += f.gamma_h * ma_;
  s.kinetic = 0.5 * s.v.dot(mv_);
  s.dissipated += 0.25 * f.h * old_v_.dot(s.damping);
  wires_.multiply(s.v, x_);
  s.damping = p.damping.stiffness * x_ + p.damping.mass * mv_;
  s.dissipated += 0.25 * f.h * (2 * old_v_.dot(s.damping) + s.v.dot(s.damping));
  s.work += 0.5 * (l0.dot(s.u) + l1.dot(s.u) - work_before);
  // u' K u from the internal forces, which hold K u, the slack droppers and less the contact forces.
  double strain = s.u.dot(s.internal) - s.u.dot(s.damping) + l1.dot(s.u);
  for (int j = 0; j < static_cast<int>(s.slack.size()); ++j)
    if (s.slack[j] != 0) strain -= line_.shape.stiffness[j] * s.slack[j] * (stretch(line_.mesh, s.u, j) + s.slack[j]);
  s.elastic = 0.5 * strain;
  return true;
}

void Hht::step_variation(const StepFactors& f, const Loads& dl1, const LineState& to, LineState& d) {
  if (d.u.isZero(0) && d.v.isZero(0) && d.a.isZero(0) && d.internal.isZero(0)) {
    // The usual case, a single step: nothing has varied before it.
    mv_.setZero();
    dl1.add_to(d.a, f.weight);
    f.factor.solve(d.a);
  } else {
    predict(f, dl1, d);
  }
  trial_forces(d.u, d.a, f.beta_h2);
  slackening_.solve_variation(trial_, f.droppers.compliance(), to.slack, d.slack);
  correct(f, d);
  mv_ += f.gamma_h * ma_;
  d.kinetic = to.v.dot(mv_);
}

}  // namespace zspring::catenary
