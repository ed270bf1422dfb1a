'use strict';
/* What a trace says of its spectrum and its memory, brought up to date with every tick that has been passed. */
(() => {
  const rub = (globalThis.rub ??= {});
  const SEGMENT = 1024;
  const LAGS = 66;
  const estimates = {};
  const window = Float64Array.from({ length: SEGMENT }, (_, i) => Math.sin((Math.PI * (i + 0.5)) / SEGMENT) ** 2);
  const power = window.reduce((sum, w) => sum + w * w, 0);
  let welch = null;
  let shared = null;

  /** Transform real and imaginary parts in place (Cooley and Tukey, a power of two of them). */
  function fourier(re, im) {
    const n = re.length;
    for (let i = 1, j = 0; i < n; i += 1) {
      let bit = n >> 1;
      for (; j & bit; bit >>= 1) j ^= bit;
      j ^= bit;
      if (i < j) {
        [re[i], re[j]] = [re[j], re[i]];
        [im[i], im[j]] = [im[j], im[i]];
      }
    }
    for (let size = 2; size <= n; size *= 2) butterflies(re, im, size);
  }

  function butterflies(re, im, size) {
    const half = size / 2;
    for (let k = 0; k < half; k += 1) {
      const c = Math.cos((-2 * Math.PI * k) / size);
      const s = Math.sin((-2 * Math.PI * k) / size);
      for (let i = k; i < re.length; i += size) {
        const j = i + half;
        const x = re[j] * c - im[j] * s;
        const y = re[j] * s + im[j] * c;
        re[j] = re[i] - x;
        im[j] = im[i] - y;
        re[i] += x;
        im[i] += y;
      }
    }
  }

  /** Begin anew where the run is another one or has gone back. */
  function current(kept, make) {
    const { trace, ticksSeen } = rub.run;
    return kept && kept.trace === trace && kept.done <= ticksSeen + 1 ? kept : { trace, done: 0, ...make() };
  }

  /**
   * Return the two-sided spectral density of A_r in um^4 per rad/um by Welch's method, about the exact mean: Hann
   * windows of 1024 ticks, each half over the one before.
   */
  estimates.spectrum = () => {
    welch = current(welch, () => ({ sums: new Float64Array(SEGMENT / 2), segments: 0 }));
    for (; welch.done + SEGMENT <= rub.run.ticksSeen + 1; welch.done += SEGMENT / 2) addSegment(welch);
    const { tick } = welch.trace;
    const wavenumber = [];
    const density = [];
    for (let i = 1; welch.segments && i < SEGMENT / 2; i += 1) {
      wavenumber.push((2 * Math.PI * i) / (SEGMENT * tick));
      density.push(((tick / power) * welch.sums[i]) / welch.segments);
    }
    return { wavenumber, density, segments: welch.segments };
  };

  function addSegment({ trace, done, sums }) {
    const mean = rub.exact().areaMean;
    const re = window.map((w, i) => w * (trace.area[done + i] - mean));
    const im = new Float64Array(SEGMENT);
    fourier(re, im);
    for (let i = 0; i < SEGMENT / 2; i += 1) sums[i] += re[i] * re[i] + im[i] * im[i];
    welch.segments += 1;
  }

  /** Return the autocovariance of A_r about the exact mean over that at lag 0, at lags up to 1.3 lives. */
  estimates.memory = () => {
    shared = current(shared, () => ({ sums: new Float64Array(LAGS) }));
    const { trace, sums } = shared;
    const stride = Math.max(1, Math.round((1.3 * rub.exact().lifeMean) / (LAGS * trace.tick)));
    const mean = rub.exact().areaMean;
    for (; shared.done <= rub.run.ticksSeen; shared.done += 1) {
      const now = trace.area[shared.done] - mean;
      for (let i = 0; i < LAGS && i * stride <= shared.done; i += 1)
        sums[i] += now * (trace.area[shared.done - i * stride] - mean);
    }
    const pairs = (i) => Math.max(1, shared.done - i * stride);
    const lag = Array.from(sums, (_, i) => i * stride * trace.tick);
    return { lag, value: Array.from(sums, (sum, i) => sum / pairs(i) / (sums[0] / pairs(0))) };
  };

  estimates.fourier = fourier;
  rub.estimates = estimates;
})();
