// Droppers that pull and never push.
//
//   f = max(0, T0 + k e),   e the stretch since the static state
//
// is written f = T0 + k e + k s with the slack s >= 0 that a dropper hangs loose by, and f s = 0. Linear but for
// s, the line answers to it with a compliance matrix, which leaves a linear complementarity problem in s alone.
// Its matrix is positive definite: there is one solution, and principal pivoting finds it in finitely many steps
// (Murty 1974; by blocks, Kostreva 1978, Judice and Pires 1994).
#pragma once

#include <Eigen/Cholesky>
#include <optional>

#include "block_cholesky.hpp"
#include "mesh.hpp"

namespace zspring::catenary {

// How a factorised matrix A answers to unit forces that pull a dropper's ends together, columns of A^-1 B.
class DropperResponse {
 public:
  DropperResponse(const Mesh& mesh, const BlockCholesky& factor, double scale);

  const MatrixXd& compliance() const { return compliance_; }  // scale B' A^-1 B, m/N
  void add(int dropper, double factor, VectorXd& x) const;    // x += factor A^-1 b

 private:
  struct Column {
    Eigen::Index begin;  // outside of begin .. begin + size it is below rounding
    VectorXd values;
  };
  std::vector<Column> columns_;
  MatrixXd compliance_;
};

inline double stretch(const Mesh& mesh, const VectorXd& u, int dropper) {
  const int station = mesh.droppers[dropper];
  return u[deflection(station, Messenger)] - u[deflection(station, Contact)];
}
// `force` N pulls both ends of the dropper together: added to internal forces.
inline void add_tension(const Mesh& mesh, int dropper, double force, VectorXd& internal) {
  const int station = mesh.droppers[dropper];
  internal[deflection(station, Messenger)] += force;
  internal[deflection(station, Contact)] -= force;
}

class Slackening {
 public:
  explicit Slackening(const VectorXd& stiffness);

  // From `trial` N, the forces with s = 0, to the slack s, m; begins with what is slack in s. Returns the number
  // of linear systems solved; none when it found no solution, which rounding alone could cause.
  std::optional<int> solve(const VectorXd& trial, const MatrixXd& compliance, VectorXd& s);
  // Its derivative: the same droppers stay slack, with variations in place of values.
  void solve_variation(const VectorXd& trial, const MatrixXd& compliance, const VectorXd& s, VectorXd& ds);

 private:
  void solve_active(const VectorXd& trial, const MatrixXd& compliance, VectorXd& s);

  const VectorXd stiffness_;
  Eigen::VectorXi active_;  // indices of what is slack, the first count_
  Eigen::Index count_ = 0;
  MatrixXd matrix_;  // workspace
  VectorXd right_, force_;
  std::vector<char> is_active_;
};

}  // namespace zspring::catenary
