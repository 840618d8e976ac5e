// A matrix that couples the nodes of each wire with their neighbours alone, as stiffness and mass of the wires do: a
// fraction of the work of a general sparse matrix.
#pragma once

#include <vector>

#include "sparse.hpp"
#include "sweeps.hpp"

namespace zspring::catenary {

class WireOperator {
 public:
  // A symmetric matrix; its blocks between two stations must not couple the wires.
  explicit WireOperator(const SparseMatrix& matrix);

  void multiply(const VectorXd& x, VectorXd& y) const {  // y = matrix x, without allocation
    sweeps::multiply(rows(), {0, static_cast<int>(rows_.size())}, x.data(), y.data());
  }
  const StationRow* rows() const { return rows_.data(); }

 private:
  std::vector<StationRow> rows_;
};

}  // namespace zspring::catenary
