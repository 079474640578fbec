/* Film thickness after Ertel and Grubin; see film.py. */
#ifndef ERTEL_GRUBIN_H
#define ERTEL_GRUBIN_H
#include "rollslip.h"

int ertel_grubin(const rs_slices *slices, const void *params);
#endif
