// An FMU state as bytes: a header that tells where it comes from, then the numbers.
#pragma once

#include <cstddef>

#include "common/numbers.hpp"

namespace zspring::fmi {

std::size_t serialized_size(const Numbers& numbers);
void serialize(const Numbers& numbers, char* bytes);

// Throws Refusal for bytes of another model or version, of a wrong length, or damaged.
Numbers deserialize(const char* bytes, std::size_t size);

}  // namespace zspring::fmi
