// FNV-1a, 64 bits: to notice damage, not to resist an attacker.
#pragma once

#include <cstddef>
#include <cstdint>

namespace zspring {

inline std::uint64_t checksum(const void* bytes, std::size_t size) {
  std::uint64_t hash = 14695981039346656037u;
  const auto* byte = static_cast<const unsigned char*>(bytes);
  for (std::size_t i = 0; i < size; ++i) hash = (hash ^ byte[i]) * 1099511628211u;
  return hash;
}

}  // namespace zspring
