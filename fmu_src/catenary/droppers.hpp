// Droppers that pull and never push.
//
//   f = max(0, T0 + k e),   e the stretch since the static state
//
// is written f = T0 + k e + k s with the slack s >= 0 that a dropper hangs loose by, and f s = 0. Linear but for
// s, the line answers to it with a compliance matrix, which leaves a linear complementarity problem in s alone.
// Its matrix is positive definite: there is one solution, and principal pivoting finds it in finitely many steps
// (Murty 1974; by blocks, Kostreva 1978, Judice and Pires 1994).
#pragma once

#include <algorithm>
#include <optional>

#include "block_cholesky.hpp"
#include "mesh.hpp"

namespace zspring::catenary {

// The droppers at these stations.
inline Range droppers_at(const Mesh& mesh, Range on) {
  const auto index = [&](int station) {
    return static_cast<int>(std::lower_bound(mesh.droppers.begin(), mesh.droppers.end(), station) -
                            mesh.droppers.begin());
  };
  return {index(on.begin), index(on.end)};
}

// How a factorised matrix A answers to unit forces that pull a dropper's ends together, columns of A^-1 B.
class DropperResponse {
 public:
  DropperResponse(const Mesh& mesh, const BlockCholesky& factor, double scale);

  // Adds to `forces`, N, of the droppers what a pull of the dropper j by `pull` N does to them, each of `stiffness`.
  void relieve(int j, double pull, const VectorXd& stiffness, VectorXd& forces) const;
  double compliance(int i, int j) const;  // scale b_i' A^-1 b_j, m/N
  // What slack beyond `usual` of droppers of `stiffness` does to x, times `factor`; returns where.
  Range add(double factor, const VectorXd& stiffness, const VectorXd& slack, const VectorXd& usual, VectorXd& x) const;

 private:
  struct Column {
    Range on;  // outside of them it is below rounding
    VectorXd values;
    Range droppers;        // there
    VectorXd compliances;  // of these
  };
  std::vector<Column> columns_;
};

inline double stretch(const Mesh& mesh, const VectorXd& u, int dropper) {
  return u[mesh.upper[dropper]] - u[deflection(mesh.droppers[dropper], Contact)];
}
// `force` N pulls both ends of the dropper together: added to internal forces.
inline void add_tension(const Mesh& mesh, int dropper, double force, VectorXd& internal) {
  internal[mesh.upper[dropper]] += force;
  internal[deflection(mesh.droppers[dropper], Contact)] -= force;
}

// Of all droppers, as if they pulled and pushed.
SparseMatrix dropper_stiffness(const Mesh& mesh, const VectorXd& stiffness);

class Slackening {
 public:
  explicit Slackening(const VectorXd& stiffness);

  // From `trial` N, the forces with s = 0, to the slack s, m; begins with what is slack in s. Returns the number
  // of linear systems solved; none when it found no solution, which rounding alone
  // could cause, or more than 1024 are slack at once.
  std::optional<int> solve(const VectorXd& trial, const DropperResponse& response, VectorXd& s);
  // Its derivative: the same droppers stay slack, with variations in place of values.
  void solve_variation(const VectorXd& trial, const DropperResponse& response, const VectorXd& s, VectorXd& ds);

 private:
  void solve_active(const VectorXd& trial, const DropperResponse& response, VectorXd& s);

  const VectorXd stiffness_;
  Eigen::VectorXi active_;  // indices of what is slack, the first count_
  Eigen::Index count_ = 0;
  VectorXd matrix_, right_, force_;  // workspace
  std::vector<char> is_active_;
};

}  // namespace zspring::catenary
