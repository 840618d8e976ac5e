// Eigen without vector instructions of its own, to be included before any of its headers.
//
// For the pantograph's few numbers they cost half as much again: written one by one and read two at once, numbers must
// first reach the memory (measured in pairs of runs). The line's long loops are sweeps of our own
// (catenary/sweeps.hpp). And on 64-bit ARM they multiply and add in one operation, so that results would have other
// bits.
#pragma once

#ifndef EIGEN_DONT_VECTORIZE
#define EIGEN_DONT_VECTORIZE
#endif
#include <Eigen/Core>
