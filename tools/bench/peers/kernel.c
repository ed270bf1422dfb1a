/* The pulse kernel in C: the area of every junction added to the ticks of its life, in three ways.
   Compiled with the coefficients of the polynomial as -DCOEFFICIENTS=..., in order of rising powers. */

#include <math.h>
#include <stddef.h>

static const double C[16] = {COEFFICIENTS};

static size_t first_tick(double distance, double tick, size_t ticks)
{
    if (distance <= 0.0) return 0;
    size_t n = (size_t)(distance / tick);
    if (n >= ticks) return ticks;
    while (n > 0 && (double)(n - 1) * tick >= distance) n--;
    while (n < ticks && (double)n * tick < distance) n++;
    return n;
}

/* d^2 u^1.5 g(u), u = 1 - |1 - s/d|: nothing but a square root and a polynomial, which vector units like. */
static void add_polynomial(const double *restrict s, size_t n, double birth, double d, double *restrict total)
{
    const double inverse = 1.0 / d, weight = d * d;
    for (size_t i = 0; i < n; i++) {
        double along = (s[i] - birth) * inverse, back = 2.0 - along;
        double u = along < back ? along : back;
        u = u > 0.0 ? u : 0.0;
        double g = C[15];
        for (int k = 14; k >= 0; k--) g = g * u + C[k];
        total[i] += weight * (u * sqrt(u) * g);
    }
}

/* What is left when the polynomial costs nothing: the square roots alone. */
static void add_roots(const double *restrict s, size_t n, double birth, double d, double *restrict total)
{
    const double inverse = 1.0 / d, weight = d * d;
    for (size_t i = 0; i < n; i++) {
        double along = (s[i] - birth) * inverse, back = 2.0 - along;
        double u = along < back ? along : back;
        u = u > 0.0 ? u : 0.0;
        total[i] += weight * sqrt(u);
    }
}

/* The formula as it stands in a book. */
static void add_textbook(const double *restrict s, size_t n, double birth, double d, double *restrict total)
{
    for (size_t i = 0; i < n; i++) {
        double x = fmin(fabs(d - (s[i] - birth)), d);
        total[i] += 0.5 * (d * d * acos(x / d) - x * sqrt(d * d - x * x));
    }
}

#define DEPOSIT(name, add)                                                                                     \
    void name(const double *s, size_t ticks, double tick, const double *birth, const double *diameter,          \
              size_t junctions, double *total)                                                                  \
    {                                                                                                           \
        for (size_t j = 0; j < junctions; j++) {                                                                \
            size_t first = first_tick(birth[j], tick, ticks);                                                   \
            size_t last = first_tick(birth[j] + 2.0 * diameter[j], tick, ticks);                                \
            add(s + first, last - first, birth[j], diameter[j], total + first);                                 \
        }                                                                                                       \
    }

DEPOSIT(deposit_polynomial, add_polynomial)
DEPOSIT(deposit_roots, add_roots)
DEPOSIT(deposit_textbook, add_textbook)
