// What a copy of the FMU made by `zspring export` begins with. Hosts hand fmuGUID on as the model description has it,
// so it carries, where the resources' location would depend on the host, what description and library must agree upon:
//
//   {GUID}[ reals][ NAME=CHECKSUM][ REFERENCE=BITS]...
//
// reals: every variable is declared as Real; NAME: that of the model's Table, which is in the resources' file
// NAME.table with that checksum; BITS: the start value of the variable with that value reference, the 16 hexadecimal
// digits of an IEEE double, whatever the host's locale.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace zspring::fmi {

struct Origin {
  bool reals = false;
  std::optional<std::uint64_t> table;  // its checksum
  std::vector<std::pair<unsigned, double>> starts;

  // Throws Refusal where this is no copy of this FMU.
  static Origin of(const char* guid);
};

}  // namespace zspring::fmi
