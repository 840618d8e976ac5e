#include "droppers.hpp"

#include <algorithm>
#include <limits>

namespace zspring::catenary {

DropperResponse::DropperResponse(const Mesh& mesh, const BlockCholesky& factor, double scale) {
  const int n = static_cast<int>(mesh.droppers.size());
  compliance_.resize(n, n);
  VectorXd x(mesh.dofs());
  for (int j = 0; j < n; ++j) {
    x.setZero();
    add_tension(mesh, j, 1, x);
    factor.solve(x);
    for (int i = 0; i < n; ++i) compliance_(i, j) = scale * stretch(mesh, x, i);
    const double negligible = 1e-2 * std::numeric_limits<double>::epsilon() * x.cwiseAbs().maxCoeff();
    Eigen::Index begin = 0, end = x.size();
    while (begin < end && std::abs(x[begin]) < negligible) ++begin;
    while (end > begin && std::abs(x[end - 1]) < negligible) --end;
    columns_.push_back({begin, x.segment(begin, end - begin)});
  }
}

void DropperResponse::add(int dropper, double factor, VectorXd& x) const {
  const Column& c = columns_[dropper];
  x.segment(c.begin, c.values.size()) += factor * c.values;
}

Slackening::Slackening(const VectorXd& stiffness)
    : stiffness_(stiffness),
      active_(stiffness.size()),
      matrix_(stiffness.size(), stiffness.size()),
      right_(stiffness.size()),
      force_(stiffness.size()),
      is_active_(static_cast<size_t>(stiffness.size())) {}

// Of f = trial + (k - k compliance k) s, the equations f = 0 of the active droppers.
void Slackening::solve_active(const VectorXd& trial, const MatrixXd& compliance, VectorXd& s) {
  for (Eigen::Index a = 0; a < count_; ++a) {
    const int i = active_[a];
    right_[a] = -trial[i];
    for (Eigen::Index b = 0; b < count_; ++b) {
      const int j = active_[b];
      matrix_(a, b) = (i == j ? stiffness_[i] : 0) - stiffness_[i] * compliance(i, j) * stiffness_[j];
    }
  }
  Eigen::Ref<MatrixXd> matrix = matrix_.topLeftCorner(count_, count_);
  const Eigen::LLT<Eigen::Ref<MatrixXd>> factor(matrix);
  auto solution = right_.head(count_);
  factor.solveInPlace(solution);
  s.setZero();
  for (Eigen::Index a = 0; a < count_; ++a) s[active_[a]] = solution[a];
}

std::optional<int> Slackening::solve(const VectorXd& trial, const MatrixXd& compliance, VectorXd& s) {
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
    if (count_ > 0)
      solve_active(trial, compliance, s);
    else
      s.setZero();
    force_ = trial;
    for (Eigen::Index a = 0; a < count_; ++a) {
      const int j = active_[a];
      const double pull = stiffness_[j] * s[j];
      force_.array() -= pull * stiffness_.array() * compliance.col(j).array();
      force_[j] += pull;
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

void Slackening::solve_variation(const VectorXd& trial, const MatrixXd& compliance, const VectorXd& s, VectorXd& ds) {
  count_ = 0;
  for (Eigen::Index i = 0; i < s.size(); ++i)
    if (s[i] > 0) active_[count_++] = static_cast<int>(i);
  ds.setZero();
  if (count_ > 0) solve_active(trial, compliance, ds);
}

}  // namespace zspring::catenary
