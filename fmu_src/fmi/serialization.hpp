// An FMU state as bytes: a header that tells where it comes from, then the numbers.
#pragma once

#include <cstddef>
#include <vector>

namespace zspring::fmi {

std::size_t serialized_size(const std::vector<double>& numbers);
void serialize(const std::vector<double>& numbers, char* bytes);

// Throws Refusal for bytes of another model or version, of a wrong length, or damaged.
std::vector<double> deserialize(const char* bytes, std::size_t size);

}  // namespace zspring::fmi
