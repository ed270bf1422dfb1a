/* Welch's estimate of a two-sided spectral density, as the commands make it, and how far a bin of it may stray. */
/** The estimate of Hann segments of so many ticks that half overlap, each less its mean: density by bin, and segments. */
view.welch = (values, step, ticks) => {
  const sum = new rub.Welch(ticks);
  for (let begin = 0; begin + ticks <= values.length; begin += ticks / 2) {
    const part = values.subarray(begin, begin + ticks);
    sum.add(part, part.reduce((total, x) => total + x, 0) / ticks);
  }
  return { density: sum.density(step), segments: sum.segments };
};

/** Factors between which 95 % of bins lie about what is expected, of a Gaussian record.

   A bin is chi-squared with 2 K / (1 + 2 (1 - 1/K) / 36) degrees of freedom: halves of Hann windows share 1/6.
   Quantiles by Wilson and Hilferty (1931). */
view.strayOf = (segments) => {
  const spread = (1 + (2 * (1 - 1 / segments)) / 36) / (9 * segments);
  return [-1.96, 1.96].map((z) => Math.max(1 - spread + z * Math.sqrt(spread), 0) ** 3);
};
