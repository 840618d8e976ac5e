// Messages to the host, by category.
#pragma once

#include <string>

#include "common/failure.hpp"
#include "fmi2FunctionTypes.h"
#include "variables.inc"

namespace zspring::fmi {

#define ZSPRING_CATEGORY(name) name,
enum class Category { ZSPRING_LOG_CATEGORIES(ZSPRING_CATEGORY) };

class Log {
 public:
  // Copies what it needs: the host's pointers live for the call only.
  Log(const fmi2CallbackFunctions& functions, const char* instance_name, bool debug);

  // The text is plain; it reaches the host as a format without directives.
  void write(fmi2Status status, Category category, const Text& message) const;
  bool enabled(Category c) const { return mask_ >> static_cast<int>(c) & 1; }

  // On: just the named categories, all when none is named; off: not those. Why a call was refused or discarded is
  // always told. Returns the first name that is not declared, or null.
  const char* enable(bool on, size_t n, const fmi2String names[]);

 private:
  fmi2CallbackLogger logger_;
  fmi2ComponentEnvironment environment_;
  std::string instance_name_;
  unsigned mask_;
};

}  // namespace zspring::fmi
