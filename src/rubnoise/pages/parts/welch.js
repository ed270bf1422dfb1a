/* Welch's estimate of a two-sided spectral density, as the commands make it, and how far a bin of it may stray. */
"use strict";
(() => {
  /** Transform in place: real and imaginary parts of a power of two of values. */
  const transform = (re, im) => {
    const n = re.length;
    for (let i = 1, j = 0; i < n; i += 1) {
      let bit = n >> 1;
      for (; j & bit; bit >>= 1) j ^= bit;
      j ^= bit;
      if (i < j) [re[i], re[j], im[i], im[j]] = [re[j], re[i], im[j], im[i]];
    }
    for (let size = 2; size <= n; size *= 2) {
      const turn = (-2 * Math.PI) / size;
      for (let k = 0; k < size / 2; k += 1) {
        const [c, s] = [Math.cos(turn * k), Math.sin(turn * k)];
        for (let i = k; i < n; i += size) {
          const j = i + size / 2;
          const [a, b] = [c * re[j] - s * im[j], c * im[j] + s * re[j]];
          [re[j], im[j]] = [re[i] - a, im[i] - b];
          [re[i], im[i]] = [re[i] + a, im[i] + b];
        }
      }
    }
  };

  /** The estimate from Hann segments of n ticks that half overlap, each less its mean: density by bin, and segments. */
  view.welch = (values, step, n) => {
    const segments = Math.floor((2 * values.length) / n) - 1;
    const density = new Float64Array(n / 2 + 1);
    const window = Float64Array.from({ length: n }, (_, i) => Math.sin((Math.PI * i) / n) ** 2);
    const energy = window.reduce((sum, w) => sum + w * w, 0);
    for (let segment = 0; segment < segments; segment += 1) {
      const part = values.subarray((segment * n) / 2, (segment * n) / 2 + n);
      const mean = part.reduce((sum, x) => sum + x, 0) / n;
      const [re, im] = [Float64Array.from(part, (x, i) => window[i] * (x - mean)), new Float64Array(n)];
      transform(re, im);
      for (let bin = 0; bin < density.length; bin += 1) {
        density[bin] += (step * (re[bin] ** 2 + im[bin] ** 2)) / energy / segments;
      }
    }
    return { density, segments };
  };

  /** Factors between which 95 % of bins lie about what is expected, of a Gaussian record.

     A bin is chi-squared with 2 K / (1 + 2 (1 - 1/K) / 36) degrees of freedom: halves of Hann windows share 1/6.
     Quantiles by Wilson and Hilferty (1931). */
  view.strayOf = (segments) => {
    const spread = (1 + (2 * (1 - 1 / segments)) / 36) / (9 * segments);
    return [-1.96, 1.96].map((z) => Math.max(1 - spread + z * Math.sqrt(spread), 0) ** 3);
  };
})();
