#include "droppers.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <utility>

namespace zspring::catenary {

DropperResponse::DropperResponse(const Mesh& mesh, const BlockCholesky& factor, double scale) {
  VectorXd x = VectorXd::Zero(mesh.dofs());
  for (int j = 0; j < static_cast<int>(mesh.droppers.size()); ++j) {
    add_tension(mesh, j, 1, x);
    const int station = mesh.droppers[j];
    const Range on = factor.solve(x, {station, station + 1});
    Column c{on, x.segment(4 * on.begin, 4 * (on.end - on.begin)), droppers_at(mesh, on), {}};
    c.compliances.resize(c.droppers.end - c.droppers.begin);
    for (int i = c.droppers.begin; i < c.droppers.end; ++i)
      c.compliances[i - c.droppers.begin] = scale * stretch(mesh, x, i);
    x.segment(4 * on.begin, c.values.size()).setZero();
    columns_.push_back(std::move(c));
  }
}

void DropperResponse::relieve(int j, double pull, const VectorXd& stiffness, VectorXd& forces) const {
  const Column& c = columns_[j];
  const auto in = [&](auto& x) { return x.segment(c.droppers.begin, c.compliances.size()).array(); };
  in(forces) -= pull * in(stiffness) * c.compliances.array();
  forces[j] += pull;
}

double DropperResponse::compliance(int i, int j) const {
  const Column& c = columns_[j];
  return i >= c.droppers.begin && i < c.droppers.end ? c.compliances[i - c.droppers.begin] : 0;
}

Range DropperResponse::add(double factor, const VectorXd& stiffness, const VectorXd& slack, const VectorXd& usual,
                           VectorXd& x) const {
  Range on{0, 0};
  for (int j = 0; j < static_cast<int>(slack.size()); ++j)
    if (const double more = slack[j] - usual[j]; more != 0) {
      const Column& c = columns_[j];
      x.segment(4 * c.on.begin, c.values.size()) += -factor * stiffness[j] * more * c.values;
      on = on.with(c.on);
    }
  return on;
}

SparseMatrix dropper_stiffness(const Mesh& mesh, const VectorXd& stiffness) {
  std::vector<Eigen::Triplet<double>> springs;
  for (size_t j = 0; j < mesh.droppers.size(); ++j) {
    const int contact = deflection(mesh.droppers[j], Contact), upper = mesh.upper[j];
    const double k = stiffness[static_cast<Eigen::Index>(j)];
    springs.emplace_back(contact, contact, k), springs.emplace_back(upper, upper, k);
    springs.emplace_back(contact, upper, -k), springs.emplace_back(upper, contact, -k);
  }
  SparseMatrix k(mesh.dofs(), mesh.dofs());
  k.setFromTriplets(springs.begin(), springs.end());
  return k;
}

constexpr Eigen::Index most_slack = 1024;  // at once; a matrix of 8 MB

Slackening::Slackening(const VectorXd& stiffness)
    : stiffness_(stiffness),
      active_(stiffness.size()),
      matrix_(std::min<Eigen::Index>(stiffness.size(), most_slack) *
              std::min<Eigen::Index>(stiffness.size(), most_slack)),
      right_(stiffness.size()),
      force_(stiffness.size()),
      is_active_(static_cast<size_t>(stiffness.size())) {}

// Of f = trial + (k - k compliance k) s, the equations f = 0 of the active droppers.
void Slackening::solve_active(const VectorXd& trial, const DropperResponse& response, VectorXd& s) {
  Eigen::Map<MatrixXd> matrix(matrix_.data(), count_, count_);
  for (Eigen::Index a = 0; a < count_; ++a) {
    const int i = active_[a];
    right_[a] = -trial[i];
    for (Eigen::Index b = 0; b < count_; ++b) {
      const int j = active_[b];
      matrix(a, b) = (i == j ? stiffness_[i] : 0) - stiffness_[i] * response.compliance(i, j) * stiffness_[j];
    }
  }
  const Eigen::LLT<Eigen::Ref<MatrixXd>> factor(matrix);
  auto solution = right_.head(count_);
  factor.solveInPlace(solution);
  s.setZero();
  for (Eigen::Index a = 0; a < count_; ++a) s[active_[a]] = solution[a];
}

std::optional<int> Slackening::solve(const VectorXd& trial, const DropperResponse& response, VectorXd& s) {
  const Eigen::Index n = trial.size();
  const double tolerance = 1e-9 * std::max(1.0, n > 0 ? trial.cwiseAbs().maxCoeff() : 0);  // N
  for (Eigen::Index i = 0; i < n; ++i) is_active_[i] = s[i] > 0;
  Eigen::Index fewest = n + 1;
  int patience = 10;  // blocks of exchanges that may fail to improve, before single ones, which cannot cycle
  const int most = 100 + 20 * static_cast<int>(n);
  for (int solved = 0; solved < most; ++solved) {
    count_ = 0;
    for (Eigen::Index i = 0; i < n; ++i)
      if (is_active_[i]) active_[count_++] = static_cast<int>(i);
    if (count_ > most_slack) return std::nullopt;
    if (count_ > 0)
      solve_active(trial, response, s);
    else
      s.setZero();
    force_ = trial;
    for (Eigen::Index a = 0; a < count_; ++a) {
      const int j = active_[a];
      response.relieve(j, stiffness_[j] * s[j], stiffness_, force_);
    }
    Eigen::Index wrong = 0, last_wrong = 0;
    const auto is_wrong = [&](Eigen::Index i) {
      return is_active_[i] ? stiffness_[i] * s[i] < -tolerance : force_[i] < -tolerance;
    };
    for (Eigen::Index i = 0; i < n; ++i)
      if (is_wrong(i)) ++wrong, last_wrong = i;
    if (wrong == 0) {
      s = s.cwiseMax(0.0);  // what rounding left
      return solved + 1;
    }
    if (wrong < fewest)
      fewest = wrong, patience = 10;
    else
      --patience;
    if (patience < 0) {
      is_active_[last_wrong] ^= 1;
      continue;
    }
    for (Eigen::Index i = 0; i < n; ++i) force_[i] = is_wrong(i);
    for (Eigen::Index i = 0; i < n; ++i)
      if (force_[i] > 0) is_active_[i] ^= 1;
  }
  return std::nullopt;
}

void Slackening::solve_variation(const VectorXd& trial, const DropperResponse& response, const VectorXd& s,
                                 VectorXd& ds) {
  count_ = 0;
  for (Eigen::Index i = 0; i < s.size(); ++i)
    if (s[i] > 0) active_[count_++] = static_cast<int>(i);
  ds.setZero();
  if (count_ > 0 && count_ <= most_slack) solve_active(trial, response, ds);
}

}  // namespace zspring::catenary
