#pragma once

// For a function that gains by wider registers: one binary for any x86-64, of which the loader
// picks the version for the machine it starts on. Its resolver runs before a sanitizer has set
// itself up, so sanitized builds have the plain version only.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(KOLSKY_SANITIZED)
#define KOLSKY_WIDE __attribute__((target_clones("default", "avx2")))
#else
#define KOLSKY_WIDE
#endif
