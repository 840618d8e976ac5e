// Cholesky factor L D L' of a symmetric matrix that is block tridiagonal with a block for each station.
//
// Eigen's sparse LDLT gives the same in several times the time: the wires couple each station to its neighbours
// alone, and blocks of 4 x 4 go through vector registers without indices.
#pragma once

#include <vector>

#include "sparse.hpp"
#include "sweeps.hpp"

namespace zspring::catenary {

class BlockCholesky {
 public:
  // Throws Refusal where the matrix is not positive definite.
  explicit BlockCholesky(const SparseMatrix& matrix);

  // In place, without allocation.
  void solve(VectorXd& x) const { sweeps::solve(factor(), x.data()); }
  // The same where x is zero outside of `on`; returns where the solution is not below rounding, nor then zero.
  Range solve(VectorXd& x, Range on) const { return sweeps::solve_locally(factor(), on, x.data()); }

 private:
  sweeps::Factor factor() const {
    return {inverse_.data(), forward_.data(), backward_.data(), static_cast<int>(inverse_.size())};
  }

  std::vector<FactorBlock> inverse_;   // D_i^-1
  std::vector<FactorBlock> forward_;   // L_i,i-1
  std::vector<FactorBlock> backward_;  // L_i+1,i'
};

}  // namespace zspring::catenary
