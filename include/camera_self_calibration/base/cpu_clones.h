#pragma once

/// Before a function of plain loops over arrays: it is compiled for AVX2 as well, and the one that
/// the processor has is chosen when the library is loaded. Both give the same bits, since AVX2
/// alone fuses no product with a sum. Not under the sanitizers, which are not ready yet when the
/// choice is made, and only where the loader can choose.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__gnu_linux__) && \
    !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
#define SELFCAL_CPU_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define SELFCAL_CPU_CLONES
#endif
