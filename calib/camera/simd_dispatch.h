#pragma once

// SIMD dispatch, for files whose loops are to use all of the machine's SIMD: RGBDT_SIMD_DISPATCH
// before a function has it built for several kinds of x86-64, and the machine's picked when the
// program starts, by what it can do (arch=haswell would be for that very model and no other). No
// contraction (CMakeLists.txt) and no reassociation: all of them give the same bits. Such a
// function takes plain pointers; an Eigen type's alignment would differ from the callers'.
//
// Not under the address sanitizer, which cannot run before the program has been linked.
#if defined(__x86_64__) && defined(__GNUC__) && __GNUC__ >= 12 && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__)
#define RGBDT_SIMD_DISPATCH \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define RGBDT_SIMD_DISPATCH
#endif

// Before a loop: no round of it reads what another writes, though the compiler may not see it.
#if defined(__GNUC__) && !defined(__clang__)
#define RGBDT_INDEPENDENT _Pragma("GCC ivdep")
#else
#define RGBDT_INDEPENDENT
#endif
