/* The compiled stages over blocks of slices, and one table of them for each instruction set.
 *
 * - A stage's body gets 8 k <= 256 slices: its loops are short and of whole vectors, its scratch stays in the L1 cache.
 *   `in_blocks` cuts, and copies an odd end into padded scratch, its last slice repeated.
 * - The files of bodies are compiled once for each instruction set, here, in one translation unit: PATH(name) is the
 *   name in the set that is being compiled.
 * - The same operations in the same order everywhere. Multiply-adds are fused where the source says RS_FMA, not where a
 *   compiler likes (setup.py): the same bits on v3 and v4, and on the baseline of ARM to a last digit in few slices of
 *   laws with Eyring's stress. The baseline of x86-64 has no such instruction and differs by rounding. */
#ifndef ROLLSLIP_BLOCKS_H
#define ROLLSLIP_BLOCKS_H
#include "stages/table.h"
#include <math.h>
#include <string.h>

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"   /* taken for possible: a block without slices */
#endif

#define BLOCK 256
#define LARGEST 0x1.fffffffffffffp1023
#define LANES 8   /* of the widest set */

/* Columns by their place in rs_slices, where they adjoin, and as bits */
#define PLACE(name, unit, meaning) AT_##name,
#define BIT(name, unit, meaning) COL_##name = 1 << AT_##name,
enum { ROLLSLIP_COLUMNS(PLACE) COLUMNS };
enum { ROLLSLIP_COLUMNS(BIT) };
#undef PLACE
#undef BIT
typedef char columns_adjoin[sizeof(rs_slices) == offsetof(rs_slices, approach) + COLUMNS * sizeof(double *) ? 1 : -1];

/* Loop over the slices of a block: no value is used by the next. */
#if defined(__clang__)
#define INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#elif defined(__GNUC__)
#define INDEPENDENT _Pragma("GCC ivdep")
#else
#define INDEPENDENT
#endif
#define EACH(i, n) INDEPENDENT for (size_t i = 0; i < (n); i++)

typedef const double *__restrict given;
typedef double *__restrict filled;

static rs_slices cut(const rs_slices *whole, size_t start, size_t n) {
    rs_slices part = *whole;
    double **column = &part.approach;
    part.n = n;
    for (int c = 0; c < ROLLSLIP_N_ALWAYS; c++) column[c] += start;
    for (int c = ROLLSLIP_N_ALWAYS; part.position && c < COLUMNS; c++) column[c] += start;
    return part;
}

/* A block whose slices are no multiple of LANES, through padded scratch; no stage of the box reads where slices are */
static int with_padding(const rs_slices *part, const void *params, rs_evaluate body, unsigned reads, unsigned writes) {
    double scratch[ROLLSLIP_N_ALWAYS][BLOCK];
    rs_slices padded = *part;
    double *const *from = (double *const *)&part->approach, **to = &padded.approach;
    size_t n = part->n;
    int status;
    padded.n = (n + LANES - 1) / LANES * LANES;
    for (int c = 0; c < ROLLSLIP_N_ALWAYS; c++) {
        if (!((reads | writes) >> c & 1)) continue;
        to[c] = scratch[c];
        if (!(reads >> c & 1)) continue;
        memcpy(to[c], from[c], n * sizeof(double));
        for (size_t i = n; i < padded.n; i++) to[c][i] = from[c][n - 1];
    }
    status = body(&padded, params);
    if (status == 0)
        for (int c = 0; c < ROLLSLIP_N_ALWAYS; c++)
            if (writes >> c & 1) memcpy(from[c], scratch[c], n * sizeof(double));
    return status;
}

static int in_blocks(const rs_slices *s, const void *params, rs_evaluate body, unsigned reads, unsigned writes) {
    if (s->n == 0) return 0;
    if (s->n <= BLOCK)   /* as a chain calls, mostly */
        return s->n % LANES ? with_padding(s, params, body, reads, writes) : body(s, params);
    for (size_t start = 0; start < s->n; start += BLOCK) {
        rs_slices part = cut(s, start, s->n - start < BLOCK ? s->n - start : BLOCK);
        int status = part.n % LANES ? with_padding(&part, params, body, reads, writes) : body(&part, params);
        if (status) return status < 0 ? status : status + (int)start;
    }
    return 0;
}

/* Begins the body of a stage: columns it reads, columns it writes.  Then follows what is done for slices *s. */
#define STAGE(name, reads, writes) \
    static int PATH(name##_body)(const rs_slices *s, const void *params); \
    static int PATH(name)(const rs_slices *s, const void *params) { \
        return in_blocks(s, params, PATH(name##_body), reads, writes); \
    } \
    static int PATH(name##_body)(const rs_slices *s, const void *params)
/* Number of slices in a body, such that the compiler knows that no vector is left over */
#define WHOLE(n) ((n) & ~(size_t)(LANES - 1))

#define JOIN(name, path) name##_##path
#define JOINED(name, path) JOIN(name, path)
#define PATH(name) JOINED(name, SET)

#include "stages/names.h"

#define SET baseline
#include "stages/all.h"
#undef SET

/* GCC and clang set the instruction set of a part of a file each in its own way; by features, since older compilers do
 * not take the names x86-64-v3 and -v4 here. */
#if defined(__x86_64__) && defined(__GNUC__)
#define HAS_X86_SETS 1
#if defined(__clang__)
#define X86_V3 "avx,avx2,bmi,bmi2,f16c,fma,lzcnt,movbe"
#define X86_V4 ",avx512f,avx512bw,avx512cd,avx512dq,avx512vl"
#pragma clang attribute push(__attribute__((target(X86_V3))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx,avx2,bmi,bmi2,f16c,fma,lzcnt,movbe")
#endif
#undef RS_FMA
#undef RS_FMAF
#define RS_FMA(a, b, c) __builtin_fma(a, b, c)
#define RS_FMAF(a, b, c) __builtin_fmaf(a, b, c)
#define SET v3
#include "stages/all.h"
#undef SET
#if defined(__clang__)
#pragma clang attribute pop
#pragma clang attribute push(__attribute__((target(X86_V3 X86_V4), min_vector_width(512))), apply_to = function)
#else
#pragma GCC pop_options
#pragma GCC push_options
#pragma GCC target("avx,avx2,bmi,bmi2,f16c,fma,lzcnt,movbe")
#pragma GCC target("avx512f,avx512bw,avx512cd,avx512dq,avx512vl,prefer-vector-width=512")
#endif
#define SET v4
#include "stages/all.h"
#undef SET
#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#endif

/* Tables in rising order, as far as this build and this machine have them; NULL ends. */
static const rs_blocks *blocks_of(int set) {
    if (set == 0) return &table_baseline;
#ifdef HAS_X86_SETS
    __builtin_cpu_init();
    int v3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi")
        && __builtin_cpu_supports("bmi2");
    int v4 = v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw")
        && __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq")
        && __builtin_cpu_supports("avx512vl");
    if (set == 1 && v3) return &table_v3;
    if (set == 2 && v4) return &table_v4;
#endif
    return NULL;
}
#endif
