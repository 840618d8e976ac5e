// A matrix that couples the nodes of each wire with their neighbours alone, as stiffness and mass of the wires do,
// multiplied twice as fast as by a general sparse matrix.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sparse.hpp"

namespace zspring::catenary {

class WireOperator {
 public:
  // A symmetric matrix; its blocks between two stations must not couple the wires.
  explicit WireOperator(const SparseMatrix& matrix);

  void multiply(const VectorXd& x, VectorXd& y) const;  // y = matrix x, without allocation

 private:
  // Of (w, w') at a node, times a vector x of these: straight x + crossed (x with w and w' exchanged).
  struct Block {
    Eigen::Array2d straight = Eigen::Array2d::Zero(), crossed = Eigen::Array2d::Zero();
    Eigen::Array2d times(const Eigen::Array2d& x) const { return straight * x + crossed * x.reverse(); }
  };
  struct Node {
    Block before, here, after;  // with the same wire's nodes at the last station, this and the next
  };
  std::vector<Node> nodes_;  // two of each station, as the degrees of freedom are ordered
};

}  // namespace zspring::catenary
