#include "origin.hpp"

#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "common/failure.hpp"
#include "instance.hpp"

namespace zspring::fmi {
namespace {

// Where `text` goes on behind `beginning`; null where it begins otherwise.
const char* behind(const char* beginning, const char* text) {
  const size_t n = std::strlen(beginning);
  return std::strncmp(text, beginning, n) == 0 ? text + n : nullptr;
}

// "=BITS", 16 hexadecimal digits; goes on behind it, unless it is none.
bool read_bits(const char*& at, std::uint64_t& bits) {
  if (at[0] != '=' || std::strspn(at + 1, "0123456789abcdef") != 16) return false;
  char* end;
  bits = std::strtoull(at + 1, &end, 16);
  at = end;
  return true;
}

// " REFERENCE=BITS"; goes on behind it, unless it is none.
bool read_start(const char*& at, unsigned& reference, double& value) {
  if (at[0] != ' ' || at[1] < '0' || at[1] > '9') return false;
  char* end;
  const unsigned long long number = std::strtoull(at + 1, &end, 10);
  const char* behind_number = end;
  std::uint64_t bits;
  if (number >= variable_count || !read_bits(behind_number, bits)) return false;
  reference = static_cast<unsigned>(number);
  std::memcpy(&value, &bits, sizeof value);
  at = behind_number;
  return true;
}

}  // namespace

Origin Origin::of(const char* guid) {
  Origin origin;
  const char* at = guid ? behind(ZSPRING_GUID, guid) : nullptr;
  if (at) {
    if (const char* rest = behind(" reals", at)) {
      origin.reals = true;
      at = rest;
    }
    if (const char* rest = *Table::name && *at == ' ' ? behind(Table::name, at + 1) : nullptr) {
      std::uint64_t checksum;
      if (read_bits(rest, checksum)) origin.table = checksum, at = rest;
    }
    unsigned reference;
    double value;
    while (read_start(at, reference, value)) {
      const Variable& v = variables[reference];
      if (!v.is_parameter() && !v.is_input()) refuse("fmuGUID: %s has no start value that could be set", v.name);
      check_value(v, value);
      origin.starts.emplace_back(reference, value);
    }
  }
  if (!at || *at)
    refuse("fmuGUID = %s: must be " ZSPRING_GUID "; modelDescription.xml and library are not from the same FMU",
           guid ? guid : "NULL");
  return origin;
}

}  // namespace zspring::fmi
