// The members of a struct, for what treats all of them alike.
#pragma once

#include <tuple>

// All of them, in their order: with one more or less it does not compile.
#define ZSPRING_MEMBERS(Type, ...)   \
  inline auto members(Type& whole) { \
    auto& [__VA_ARGS__] = whole;     \
    return std::tie(__VA_ARGS__);    \
  }
