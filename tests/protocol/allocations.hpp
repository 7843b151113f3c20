#pragma once
// Counts the allocations of the whole test program, to show that a step makes none.

#include <cstddef>

std::size_t allocation_count();
